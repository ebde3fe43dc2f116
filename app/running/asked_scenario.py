"""What the options of a session name: its scenario, with its settings, and its cast."""

from dataclasses import replace

from cubeling.affect import Personality
from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import CastScenario, DressingScenario, NamingScenario
from cubeling.app.scenarios import Scenario, ScenarioSettings, make_scenario
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.characters import Character, load_to_play, with_colours
from cubeling.tracking import CubeModel


def is_replay(session: SessionFile | None, options: SessionOptions) -> bool:
    """Return whether a session is played again as it was, and not only its frames."""
    return session is not None and session.info.options.scenario == options.scenario


def settings_of(options: SessionOptions) -> ScenarioSettings:
    """Return the user's settings of a scenario; raises AppError or AffectError as reading them."""
    personality = None if options.personality is None else Personality.load(options.personality)
    return ScenarioSettings(
        options.speed_map,
        options.turns,
        personality,
        options.talk_language,
        options.asks_model,
    )


def scenario_of(options: SessionOptions, name: str, cube: CubeModel | None = None) -> Scenario:
    """Make a scenario with the user's settings; None for its own cube."""
    return make_scenario(
        name,
        cube,
        speed_map=options.speed_map,
        turns=options.turns,
        personality=options.personality,
        language=options.talk_language,
        asks_model=options.asks_model,
    )


def names_of_cast(options: SessionOptions, scenario: Scenario) -> tuple[str, ...]:
    """Return the names or files of all characters: at least one for each player."""
    chosen = options.character is not None or options.others
    own = scenario.others if isinstance(scenario, CastScenario) and not chosen else ()
    named = (options.character or scenario.character, *options.others, *own)
    return (*named, *[scenario.character] * (options.players - len(named)))


def load_cast(options: SessionOptions, scenario: Scenario) -> list[Character]:
    """Load all characters under their names, that of the first player first.

    Raises
    ------
    AppError, CharacterError
        A file cannot be read, or the character cannot stand as somebody.
    """
    cast = [
        load_to_play(
            name, own_motions_only=options.own_motions_only, whole_limbs=options.whole_limbs
        )
        for name in names_of_cast(options, scenario)
    ]
    if isinstance(scenario, DressingScenario) and not (options.character or options.others):
        dressed = zip(cast, scenario.colours, strict=False)
        cast[: len(scenario.colours)] = [with_colours(each, colours) for each, colours in dressed]
    if isinstance(scenario, NamingScenario):
        named = zip(scenario.names, cast, strict=False)
        cast = [replace(each, name=name) for name, each in named]
    if options.idle is not None:
        if options.controller != "tree":
            raise AppError(
                f"the controller {options.controller!r} stands by its own motions: leave out --idle"
            )
        from cubeling.characters import standing_as

        cast[0] = standing_as(cast[0], options.idle)
    return cast
