"""Single compilation units: with scu_build=yes, compiles up to 16 sources of a room together. A full build is then
faster, because shared headers are parsed once for all of them. Without it, an incremental build is faster, because it
compiles only the changed source."""

import os

SIZE = 16
# The macro of sources that cannot be combined. Highway compiles such a source once per instruction set, by including
# the source itself.
ALONE = "HWY_TARGET_INCLUDE"


def sources(env, out, paths):
    """Returns the nodes to compile for the sources of one room, given relative to the root. With scu_build=yes, these
    are files in `out` that include the sources."""
    if not env["scu_build"]:
        return [out + "/obj/" + path for path in paths]
    return [joined(env, out, group) if len(group) > 1 else out + "/obj/" + group[0] for group in groups(env.Dir("#").abspath, paths)]


def groups(root, paths):
    """Divides sources into groups to compile together."""
    alone = []
    for path in paths:
        with open(os.path.join(root, path), encoding="utf-8") as file:
            if ALONE in file.read():
                alone.append(path)
    together = [path for path in paths if path not in alone]
    parts = -(-len(together) // SIZE)
    cuts = [part * len(together) // parts for part in range(parts + 1)] if parts else []
    return [[path] for path in alone] + [together[start:end] for start, end in zip(cuts, cuts[1:], strict=False)]


def text_of(paths):
    """Returns the text of a source that includes these sources."""
    return "".join('#include "%s"\n' % path for path in paths)


def joined(env, out, paths):
    """Returns the node of a source that includes these sources."""
    text = text_of(paths)
    name = "%s/scu/%s.cpp" % (out, paths[0][: -len(".cpp")])
    return env.Command(name, env.Value(text), env.Action(write, "write   $TARGET"))[0]


def write(target, source, env):
    os.makedirs(os.path.dirname(target[0].abspath), exist_ok=True)
    with open(target[0].abspath, "w", encoding="utf-8") as file:
        file.write(source[0].get_text_contents())
