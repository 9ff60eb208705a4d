"""What engine code is compiled against: the godot-cpp that the user names, or the stand-in made from Godot's own dump."""

import glob
import os
import subprocess
import sys

DUMPED = ("extension_api.json", "gdextension_interface.h")


def bind(env, out, sources):
    """Prepares env for engine code; returns the objects that it must be linked with."""
    return external(env, env["godot_cpp"]) if env["godot_cpp"] else stand_in(env, out, sources)


def external(env, folder):
    """godot-cpp as its users have it: a built checkout, or an installed prefix. Its headers are not ours, so their
    warnings are not shown."""
    folder = os.path.abspath(folder)
    roots = [os.path.join(folder, part) for part in ("include", "gen/include", "gdextension")]
    archives = [
        path
        for part in ("bin", "lib", "lib64", "lib/*-linux-gnu")
        for path in sorted(glob.glob(os.path.join(folder, part, "libgodot-cpp*.a")))
    ]
    fitting = [path for path in archives if env["target"] in path and env["arch"] in path]
    if not fitting:
        have = ", ".join(os.path.relpath(path, folder) for path in archives) or "none"
        sys.exit("thicket: godot_cpp=%s holds no library for %s %s (found: %s)"
            % (folder, env["target"], env["arch"], have))  # fmt: skip
    for root in roots:
        if os.path.isdir(root):
            env.Append(CCFLAGS=["-isystem", root])
    # As godot-cpp's own build defines them for the code that links with it.
    env.Append(CPPDEFINES=["GDEXTENSION", "THREADS_ENABLED"], LIBS=[env.File(fitting[0])])
    if env["target"] != "template_release":
        env.Append(CPPDEFINES=["HOT_RELOAD_ENABLED"])
    if env["platform"] == "linux":
        env.Append(CPPDEFINES=["LINUX_ENABLED", "UNIX_ENABLED"])
    return []


def find(env):
    """(path, time) of the Godot that will be asked for its dump, or None."""
    script = env.File("#tools/godot").abspath
    answer = subprocess.run([script, "--where"], capture_output=True, text=True, check=False)
    path = answer.stdout.strip()
    return "%s %d" % (path, os.stat(path).st_mtime_ns) if answer.returncode == 0 and path else None


def dump(env):
    """Nodes of the two files in which Godot describes itself, written anew whenever another Godot is found."""
    folder = "#build/engine/"
    found = find(env)

    def run(target, source, env):
        if not found:
            print("thicket: no Godot 4.4 or newer found: run tools/setup.sh, or set GODOT, "
                "or build without the extension: scons core tests bench", file=sys.stderr)  # fmt: skip
            return 1
        where = os.path.dirname(target[0].abspath)
        command = [env.File("#tools/godot").abspath, "--headless",
            "--dump-extension-api-with-docs", "--dump-gdextension-interface"]  # fmt: skip
        done = subprocess.run(command, cwd=where, capture_output=True, text=True, check=False)
        missing = [name for name in DUMPED if not os.path.exists(os.path.join(where, name))]
        if done.returncode != 0 or missing:
            print(done.stdout + done.stderr, file=sys.stderr)
            return 1
        return 0

    action = env.Action(run, "ask     Godot what it offers")
    return env.Command([folder + name for name in DUMPED], env.Value(found or "no Godot"), action)
