"""Commands as tests ask for them: what to do by one name."""

from cubeling.characters import ActionIntent, CharacterCommand, LocomotionIntent


def command(
    timestamp,
    activity="idle",
    speed=0.0,
    target=None,
    *,
    facing=None,
    stop=True,
    weight=0.0,
    **kw,
):
    """Return a command to do something: "move", "idle" or an action."""
    going = LocomotionIntent(speed, target, stop, facing)
    action = None if activity == "move" else ActionIntent(activity, weight)
    return CharacterCommand(timestamp, going, action, **kw)
