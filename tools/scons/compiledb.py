"""Writes compile_commands.json for editors and clang's tools. SCons' tool for this would rewrite the file in every build, even
if nothing has changed."""

import json


def database(env, targets):
    """Returns the node of the file, which has the compile command of each object that the targets are built from. It is
    rewritten when the objects or their flags change."""
    objects = sorted(set(compiled(env.Flatten(targets), set())), key=str)
    # Objects of the same environment have the same flags.
    environments = {id(environment): environment for environment in (node.get_build_env() for node in objects)}.values()
    summary = [env.Dir("#").abspath, *map(str, objects)]
    summary += [environment.subst("$CXX $CXXFLAGS $CCFLAGS $_CCCOMCOM") for environment in environments]

    def write(target, source, env):
        entries = [entry(node, env.Dir("#").abspath) for node in objects]
        with open(target[0].abspath, "w", encoding="utf-8") as file:
            json.dump(entries, file, indent=1)
            file.write("\n")

    action = env.Action(write, "write   compile_commands.json")
    return env.Command("#compile_commands.json", env.Value("\n".join(summary)), action)


def compiled(nodes, seen):
    """Yields the objects compiled from C++ that the nodes are built from."""
    for node in nodes:
        if node in seen:
            continue
        seen.add(node)
        sources = getattr(node, "sources", [])
        if len(sources) == 1 and str(sources[0]).endswith(".cpp") and str(node).endswith((".o", ".obj")):
            yield node
        elif sources:
            yield from compiled(sources, seen)


def entry(node, root):
    source = node.sources[0].srcnode() if not node.sources[0].has_builder() else node.sources[0]
    command = node.get_build_env().subst("$CXXCOM", target=[node], source=[source])
    return {"directory": root, "command": command, "file": str(source), "output": str(node)}
