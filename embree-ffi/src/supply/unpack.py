"""unpack.py WHEEL SHA256 FOLDER OUT: checks the wheel's digest, then puts the files of its FOLDER flat into OUT.

They keep the wheel's dates: dated now, they would look to cargo as if they had changed since the build that fetched them.
"""
import hashlib, os, shutil, sys, time, zipfile

wheel, expected, folder, out = sys.argv[1:]
with open(wheel, "rb") as file:
    found = hashlib.sha256(file.read()).hexdigest()
if found != expected:
    sys.exit(f"the wheel's sha256 is {found}, not the pinned {expected}")
with zipfile.ZipFile(wheel) as archive:
    for member in archive.infolist():
        parent, name = os.path.split(member.filename)
        if parent == folder and name:
            path = os.path.join(out, name)
            with archive.open(member) as source, open(path, "wb") as target:
                shutil.copyfileobj(source, target)
            dated = time.mktime(member.date_time + (0, 0, -1))
            os.utime(path, (dated, dated))
