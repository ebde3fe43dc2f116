"""eSpeak NG as a voice: more than a hundred languages, with the times of words and phones."""

import ctypes.util
import importlib.util
import shutil
import sys
from pathlib import Path

from cubeling.characters.speech.voices.voice import Voice, VoiceError

PROGRAM = Path(__file__).with_name("espeak_process.py")
"""The program that loads the library; nothing else does."""


def espeak() -> Voice:
    """Return the voice of eSpeak NG; VoiceError if it is not installed."""
    found = libraries()  # which asks the system, and takes a while
    if not found:
        raise VoiceError("no voice is installed, such as eSpeak NG", espeak_remedy())
    return Voice((sys.executable, "-S", "-u", str(PROGRAM), *found))


def espeak_installed() -> bool:
    """Return whether eSpeak NG is there: as a package of the system, or as the extra `[voice]`."""
    return bool(libraries())


def libraries() -> tuple[str, ...]:
    """Return the library, and the folder of its data where it is not in its usual place; or ()."""
    found = ctypes.util.find_library("espeak-ng")
    if found is not None:
        return (found,)
    wheel = importlib.util.find_spec("espeakng_loader")
    if wheel is None or wheel.origin is None:
        return ()
    folder = Path(wheel.origin).parent
    names = ("libespeak-ng", "espeak-ng")
    there = [path for path in folder.iterdir() if path.stem.startswith(names) and path.is_file()]
    return (str(there[0]), str(folder)) if there else ()


def espeak_remedy() -> str:
    """Return the command that installs eSpeak NG on this system."""
    if shutil.which("apt-get"):
        return "sudo apt-get install -y espeak-ng"
    if shutil.which("brew"):
        return "brew install espeak-ng"
    return "pip install espeakng-loader"
