"""Print the lowest version that a wheel allows of each direct dependency, as constraints for pip.

python .ci/lowest.py motionseek-0.1.0-py3-none-any.whl serve test
"""

from __future__ import annotations

import re
import sys
import zipfile
from email.parser import HeaderParser

wheel, *extras = sys.argv[1:]
with zipfile.ZipFile(wheel) as archive:
    metadata = next(name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
    requirements = HeaderParser().parsestr(archive.read(metadata).decode()).get_all("Requires-Dist", [])

for requirement in requirements:
    extra = re.search(r"extra == ['\"](\w+)['\"]", requirement)
    lowest = re.match(r"([\w.-]+)[>=]=([\d.]+)", requirement)
    if lowest and (extra is None or extra[1] in extras):
        print(f"{lowest[1]}=={lowest[2]}")
