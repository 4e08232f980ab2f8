"""What is kept of a measurement: of which commit it is, in files that are there whole or not at all."""
import pathlib
import subprocess


def git(root, *arguments):
    """What git says of the checkout. @throws subprocess.CalledProcessError"""
    return subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True, check=True).stdout.strip()


def write(path, text):
    """The folder is made where it is not there."""
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(path.name + ".part")
    draft.write_text(text, encoding="utf-8")
    draft.replace(path)
