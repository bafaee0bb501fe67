"""unpack.py WHEEL SHA256 FOLDER OUT: checks the wheel's digest, then puts the files of its FOLDER flat into OUT."""
import hashlib, os, shutil, sys, zipfile

wheel, expected, folder, out = sys.argv[1:]
with open(wheel, "rb") as file:
    found = hashlib.sha256(file.read()).hexdigest()
if found != expected:
    sys.exit(f"the wheel's sha256 is {found}, not the pinned {expected}")
with zipfile.ZipFile(wheel) as archive:
    for member in archive.namelist():
        parent, name = os.path.split(member)
        if parent == folder and name:
            with archive.open(member) as source, open(os.path.join(out, name), "wb") as target:
                shutil.copyfileobj(source, target)
