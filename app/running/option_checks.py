"""What can be refused of a session's options before anything is loaded or opened."""

from cubeling.affect import Personality
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_character, check_input, check_motions
from cubeling.app.output_path import check_output, later_parts
from cubeling.app.pipeline.choices import check_look, check_speed_map, check_turns
from cubeling.app.session import SessionLabels, SessionOptions, check_codec
from cubeling.app.speaking.lines import (
    DEFAULT_LANGUAGE,
    SILENT,
    WATCHING,
    bundled_lines,
    read_lines_for,
)
from cubeling.app.ui.output_formats import OUTPUT_SUFFIXES, check_video_codec
from cubeling.characters import check_controller


def check_part(options: SessionOptions) -> None:
    """Refuse a part of a recording that is empty, and what nobody could end."""
    if not options.patience_s >= 0.0:  # also what is no number
        raise AppError(f"--patience is a time of 0 s or more, not {options.patience_s:g}")
    if options.loop and not options.windowed:
        raise AppError("--loop needs a window: a file would never end")
    if options.start_s < 0.0:
        raise AppError(f"--start counts from the first frame: {options.start_s:g} s is before it")
    if options.end_s is not None and options.end_s <= options.start_s:
        raise AppError(
            f"--end {options.end_s:g} is not after --start {options.start_s:g}: nothing is left"
        )


def check_output_paths(options: SessionOptions) -> None:
    """Refuse files that cannot be written."""
    if options.output is not None:
        check_output(options.output, "video", OUTPUT_SUFFIXES, overwrite=options.overwrite)
        if not options.pictures:
            raise AppError(f"without pictures there is nothing to write to '{options.output}'")
        check_video_codec(options.output, options.video_codec)
    if options.record is not None:
        check_output(options.record, "recording", (".mcap",), overwrite=False, remedy="remove it")
        if options.part_s is not None or options.part_bytes is not None:
            for part in later_parts(options.record):
                check_output(part, "recording", (".mcap",), overwrite=False, remedy="remove it")
    check_codec(options.codec)  # a key may record too


def check_inputs(options: SessionOptions) -> None:
    """Refuse names and files that there are not.

    Raises AppError, AffectError, CharacterError or RobotError. What only reading shows is left to
    those who read it.
    """
    SessionLabels(options.participant, options.condition)  # refuses what is no label
    check_look(options.look)
    check_speed_map(options.speed_map)
    check_turns(options.turns)
    check_controller(options.controller)
    if options.personality is not None:
        Personality.load(options.personality)
    check_lines(options)
    check_input(options.intrinsics, "camera file")
    check_input(options.idle, "idle motion")
    check_input(options.robot_settings, "robot settings")
    check_motions(options.motions)
    if options.sounds is not None and not any(options.sounds.glob("*.wav")):
        raise AppError(f"there are no .wav files in a folder '{options.sounds}'")
    if ":" not in options.source:  # that of a URI, or of a drive, is left to `open_source`
        check_input(options.source, "video")
    for name in (options.character, *options.others):
        check_character(name)
    for robot in (options.robot, options.second_robot):
        if robot.startswith("sim:"):
            from cubeling.robot import simulator_of

            simulator_of(robot)  # cheap, and it knows names and faults


def check_lines(options: SessionOptions) -> None:
    """Refuse lines that there are not, or not in the language that the user has chosen."""
    if options.lines is not None:
        for scenario in (options.scenario, WATCHING):
            read_lines_for(options.lines, scenario, options.language or DEFAULT_LANGUAGE)
    elif options.language not in (None, SILENT):
        bundled_lines(options.scenario, options.language)
