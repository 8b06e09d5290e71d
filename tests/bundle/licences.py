# SPDX-License-Identifier: GPL-3.0-or-later
"""licences.py WHEEL: every library in it is one of those that a program under any licence may link: permissive, LGPL as a file that
can be replaced, or GCC's run time, whose exception allows it; what they need is in the wheel or glibc's."""

import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ALLOWED = r"lib(tetlap-overlap|gmp|jansson|openblas|gomp|gfortran|quadmath|gcc_s|OpenCL)(-[0-9a-f]{8})?\.so(\.\d+)*"
GLIBC = r"(ld-linux-x86-64|libc|libm|libmvec|libdl|libpthread|librt)\.so\.\d+"


def main(wheel):
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        zipfile.ZipFile(wheel).extractall(folder)
        files = [path for path in Path(folder).rglob("*") if path.is_file() and path.read_bytes()[:4] == b"\x7fELF"]
        names = {path.name for path in files}
        for path in files:
            if not re.fullmatch(ALLOWED, path.name):
                wrong.append(f"{path.name} is not one of the libraries that may be in it")
            dynamic = subprocess.run(["readelf", "-d", path], capture_output=True, text=True, check=True).stdout
            for needed in re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic):
                if needed not in names and not re.fullmatch(GLIBC, needed):
                    wrong.append(f"{path.name} needs {needed}, which is not in it")
    if not any(name.startswith("libtetlap-overlap") for name in names):
        wrong.append("libtetlap-overlap is not in it")
    sys.exit("\n".join(f"{Path(wheel).name}: {line}" for line in wrong) or 0)


main(sys.argv[1])
