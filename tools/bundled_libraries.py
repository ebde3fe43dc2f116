"""Licences that no metadata states: of libraries inside wheels, and of some packages.

Written down from the licence files of the wheels and of the libraries' own projects, in the words
of SPDX. `python -m tools.licences` finds which libraries there are; one that is not named here
stops it.
"""

LICENCES = {
    "defusedxml": "PSF-2.0",
    "contourpy": "BSD-3-Clause",
    "cycler": "BSD-3-Clause",
    "espeakng-loader": "**none stated**: its metadata and its wheel name no licence",
    "imgui-bundle": "MIT",
    "kiwisolver": "BSD-3-Clause",
    "lz4": "BSD-3-Clause",
    "matplotlib": "matplotlib's own, after PSF-2.0",
    "opencv-contrib-python-headless": "Apache-2.0",
    "pocketsphinx": "BSD-2-Clause",
    "protobuf": "BSD-3-Clause",
    "pyserial": "BSD-3-Clause",
    "reachy-mini": "Apache-2.0",
    "shellingham": "ISC",
}
"""SPDX expressions of packages whose metadata has a sentence, a whole text or nothing instead."""

FFMPEG = "FFmpeg"
"""The library that says itself under which licence it was built."""

LIBRARIES = {
    **dict.fromkeys(
        (
            "libavcodec",
            "libavdevice",
            "libavfilter",
            "libavformat",
            "libavutil",
            "libswresample",
            "libswscale",
        ),
        (FFMPEG, ""),
    ),
    "libGLX": ("libglvnd", "MIT"),
    "libGLdispatch": ("libglvnd", "MIT"),
    "libOpenGL": ("libglvnd", "MIT"),
    "libSvtAv1Enc": ("SVT-AV1", "BSD-3-Clause-Clear"),
    "libXau": ("X.Org", "MIT"),
    "libaom": ("libaom", "BSD-2-Clause"),
    "libasound": ("ALSA", "LGPL-2.1-or-later"),
    "libavif": ("libavif", "BSD-2-Clause"),
    "libbrotlicommon": ("Brotli", "MIT"),
    "libbrotlidec": ("Brotli", "MIT"),
    "libcrypto": ("OpenSSL 1.1.1", "OpenSSL"),
    "libdav1d": ("dav1d", "BSD-2-Clause"),
    "libdrm": ("libdrm", "MIT"),
    "libespeak-ng": ("eSpeak NG", "GPL-3.0-or-later"),
    "libfreetype": ("FreeType", "FTL"),
    "libgfortran": ("GCC's Fortran library", "GPL-3.0-or-later WITH GCC-exception-3.1"),
    "libglfw": ("GLFW", "Zlib"),
    "libgmp": ("GMP", "LGPL-3.0-or-later OR GPL-2.0-or-later"),
    "libgnutls": ("GnuTLS", "LGPL-2.1-or-later"),
    "libharfbuzz": ("HarfBuzz", "MIT-Modern-Variant"),
    "libhogweed": ("Nettle", "LGPL-3.0-or-later OR GPL-2.0-or-later"),
    "libjpeg": ("libjpeg-turbo", "IJG AND BSD-3-Clause AND Zlib"),
    "liblcms2": ("Little CMS", "MIT"),
    "liblzma": ("XZ Utils", "0BSD"),
    "libmp3lame": ("LAME", "LGPL-2.0-or-later"),
    "libnettle": ("Nettle", "LGPL-3.0-or-later OR GPL-2.0-or-later"),
    "libopenblasp": ("OpenBLAS", "BSD-3-Clause"),
    "libopencore-amrnb": ("OpenCORE AMR", "Apache-2.0"),
    "libopencore-amrwb": ("OpenCORE AMR", "Apache-2.0"),
    "libopenjp2": ("OpenJPEG", "BSD-2-Clause"),
    "libopus": ("Opus", "BSD-3-Clause"),
    "libpng16": ("libpng", "libpng-2.0"),
    "libquadmath": ("GCC's quad precision", "LGPL-2.1-or-later"),
    "libscipy_openblas64": ("OpenBLAS", "BSD-3-Clause"),
    "libsharpyuv": ("libwebp", "BSD-3-Clause"),
    "libssl": ("OpenSSL 1.1.1", "OpenSSL"),
    "libtiff": ("LibTIFF", "libtiff"),
    "libunistring": ("libunistring", "LGPL-3.0-or-later OR GPL-2.0-or-later"),
    "libvpl": ("oneVPL", "MIT"),
    "libvpx": ("libvpx", "BSD-3-Clause"),
    "libwebp": ("libwebp", "BSD-3-Clause"),
    "libwebpdemux": ("libwebp", "BSD-3-Clause"),
    "libwebpmux": ("libwebp", "BSD-3-Clause"),
    "libx264": ("x264", "GPL-2.0-or-later"),
    "libx265": ("x265", "GPL-2.0-or-later"),
    "libxcb": ("X.Org", "MIT"),
    "libxcb-shape": ("X.Org", "MIT"),
    "libxcb-shm": ("X.Org", "MIT"),
    "libxcb-xfixes": ("X.Org", "MIT"),
    "libzstd": ("Zstandard", "BSD-3-Clause"),
}
"""Name and licence of a shared library in a wheel, by its file without version and hash."""

LINKED = {
    "cffi": {"libffi": "MIT"},
    "contourpy": {"pybind11": "BSD-3-Clause"},
    "dracopy": {"Draco": "Apache-2.0"},
    "imgui-bundle": {
        "Dear ImGui, ImPlot, ImPlot3D, Hello ImGui, node editor, ImmVision, MD4C, MicroTeX": "MIT",
        "Dear ImGui Test Engine": "its own, free below a turnover of 2 million dollars",
        "NanoVG": "Zlib",
        "FreeType": "FTL",
        "nanobind": "BSD-3-Clause",
        "fonts Inconsolata, Font Awesome": "OFL-1.1",
        "fonts Roboto, Droid": "Apache-2.0",
        "fonts of TeX": "GUST-Font-License",
    },
    "lz4": {"LZ4": "BSD-2-Clause"},
    "matplotlib": {
        "FreeType": "FTL",
        "Qhull": "Qhull",
        "Anti-Grain Geometry": "its own, permissive",
        "fonts DejaVu": "Bitstream-Vera",
        "fonts STIX": "OFL-1.1",
    },
    "opencv-contrib-python-headless": {
        "libjpeg-turbo": "IJG AND BSD-3-Clause AND Zlib",
        "libwebp, Protocol Buffers": "BSD-3-Clause",
        "LibTIFF": "libtiff",
        "OpenJPEG": "BSD-2-Clause",
        "ADE, FlatBuffers": "Apache-2.0",
        "Intel ITT": "BSD-3-Clause OR GPL-2.0-only",
        "Intel IPP ICV": "Intel Simplified Software License",
    },
    "pillow": {"Raqm": "MIT", "libaom, dav1d": "BSD-2-Clause", "libyuv": "BSD-3-Clause"},
    "pocketsphinx": {"a model of English": "BSD-2-Clause"},
    "protobuf": {"upb": "BSD-3-Clause", "utf8_range": "MIT"},
    "pyyaml": {"LibYAML": "MIT"},
    "typer": {"Click": "BSD-3-Clause"},
    "tzdata": {"the time zones of IANA": "public domain"},
    "zstandard": {"Zstandard": "BSD-3-Clause"},
}
"""What is linked into the modules of a wheel, or lies beside them, from its own notices."""
