"""The version of the stack: that of this package, whose package.xml lies above this folder in the sources and in the install space."""
import os
import xml.etree.ElementTree as xml


def version():
    folder = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
    return xml.parse(os.path.join(folder, "package.xml")).getroot().findtext("version")


def add_version_option(parser):
    parser.add_argument("--version", action="version", version=f"HySeLAM {version()}", help="print the version and end")
