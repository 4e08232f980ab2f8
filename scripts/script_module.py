"""Programs of this repository as modules, whose files have no ending .py."""
import importlib.machinery
import importlib.util
import pathlib
import sys


def load(path):
    """The module of a program, without its main(). Nothing is written beside it."""
    sys.dont_write_bytecode = True
    name = pathlib.Path(path).name + "_script"
    loader = importlib.machinery.SourceFileLoader(name, str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module
