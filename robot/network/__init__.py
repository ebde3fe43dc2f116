"""Characters and robots on several computers: players, robot nodes, and the bus between them.

>>> from cubeling.robot import Emotion
>>> from cubeling.robot.network import BusClient, Member, MemoryBroker, Player
>>> broker, ann = MemoryBroker(), Member("hall", "player", "ann")
>>> client = BusClient(Player(ann, session=1), broker.bus(), clock=lambda: 0.0)
>>> client.endpoint.feel(Emotion(0.8, 0.5, "happy"))
>>> client.bus.open()
>>> client.step()
>>> sorted(topic.rpartition("/")[2] for topic in broker.retained)
['emotion', 'status']
>>> client.close()
"""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
