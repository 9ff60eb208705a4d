"""With scu_build=yes, compiles up to 16 sources of a room together. A whole build then takes less time, because shared headers are read
once for all of them. Without it, a change compiles only the source that changed."""

import os

SIZE = 16
# Highway compiles such a source once for each set of instructions, by including the source itself. It cannot share that with others.
ALONE = "HWY_TARGET_INCLUDE"


def sources(env, out, paths):
    """What to compile for these sources of one room, which are relative to the root: their nodes, or with scu_build=yes those of files
    in `out` that include them."""
    if not env["scu_build"]:
        return [out + "/obj/" + path for path in paths]
    return [joined(env, out, group) if len(group) > 1 else out + "/obj/" + group[0] for group in groups(env.Dir("#").abspath, paths)]


def groups(root, paths):
    """The sources that are compiled together."""
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
    """A source that includes these sources."""
    return "".join('#include "%s"\n' % path for path in paths)


def joined(env, out, paths):
    """The node of a source that includes these sources."""
    text = text_of(paths)
    name = "%s/scu/%s.cpp" % (out, paths[0][: -len(".cpp")])
    return env.Command(name, env.Value(text), env.Action(write, "write   $TARGET"))[0]


def write(target, source, env):
    os.makedirs(os.path.dirname(target[0].abspath), exist_ok=True)
    with open(target[0].abspath, "w", encoding="utf-8") as file:
        file.write(source[0].get_text_contents())
