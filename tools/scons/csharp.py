"""Builds the add-on's C# wrappers, which tools/csharp generates from the class reference."""

import subprocess
import sys


def wrappers(env, addon):
    """Returns the nodes of the wrappers. Runs the generator once at the start of the build to list their names."""
    pages = sorted(env.Glob("#extension/doc_classes/*.xml"), key=str)
    command = [sys.executable, env.File("#tools/csharp/generate.py").abspath, *[page.srcnode().abspath for page in pages]]
    listing = subprocess.run([*command, "--list"], capture_output=True, text=True, check=False)
    if listing.returncode:
        sys.exit("thicket: tools/csharp/generate.py --list failed:\n" + listing.stderr)
    folder = addon + "/csharp"
    action = env.Action([[*command, "--out", env.Dir(folder).abspath]], "write   %s" % folder.lstrip("#"))
    wrapper_files = env.Command([folder + "/" + name for name in listing.stdout.split()], pages, action)
    env.Depends(wrapper_files, env.Glob("#tools/csharp/*.py") + env.Glob("#tools/csharp/*.in"))
    return wrapper_files
