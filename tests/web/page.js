// Starts Godot's web engine with the files of a project, attaches our library to it, and reports what the engine prints to the server.
// The engine is an official one without Extensions Support, so it does not load the library from thicket.gdextension:
//
// 1. The engine's code is changed so that its table of functions may grow.
// 2. Before the engine starts, `SideModules` attaches two modules to its memory and its table: the C and C++ libraries, which an engine with
//    Extensions Support exports, and then our library.
// 3. run.gd passes our entry point to `GDExtensionManager.load_extension_from_function`, which Godot 4.6 added for such cases.
// 4. `initLanguage` makes GDScript list all classes again, because it did so before run.gd could load the library.

import {SideModules, withGrowingTable} from "./side_modules.js";

// Reports are sent one after the other, so that the server receives them in this order.
let sent = Promise.resolve();
const report = (path, text) => {
	sent = sent.then(() => fetch(path, {method: "POST", body: text}));
};
window.report = report; // For scripts in the engine.
window.addEventListener("error", event => report("failed", event.message));
window.addEventListener("unhandledrejection", event => report("failed", String(event.reason?.stack ?? event.reason)));

const {files, args} = await (await fetch("run.json")).json();

// Keeps the engine's instance and its imports, which the engine's own script does not pass on.
let instance, given;
WebAssembly.instantiateStreaming = async (response, imports) => {
	const code = withGrowingTable(new Uint8Array(await (await response).arrayBuffer()));
	const result = await WebAssembly.instantiate(code, imports);
	instance = result.instance;
	given = {...imports.env, ...imports.wasi_snapshot_preview1};
	return result;
};

// Functions in JavaScript that the C library calls and the engine does not.
const ofSystem = {
	_emscripten_get_now_is_monotonic: () => 1,
	__syscall_getpid: () => 1,
	getentropy: (address, size) => {
		crypto.getRandomValues(new Uint8Array(instance.exports.memory.buffer, address, size));
		return 0;
	},
};

const engine = new Engine({
	executable: "engine/index",
	canvas: document.getElementById("canvas"),
	canvasResizePolicy: 0,
	args,
	onPrint: text => report("printed", text),
	onPrintError: text => report("printed", text),
	onExit: code => report("exited", String(code)),
});
await engine.init("engine/index");

const side = new SideModules(instance.exports, {...ofSystem, ...given});
const attach = async name => side.attach(await WebAssembly.compileStreaming(fetch(name)));
const runtime = await attach("runtime.wasm");
const library = await attach("library.wasm");
// For run.gd.
window.entryPoint = runtime.wrap_entry_point(side.indexOf(library.thicket_library_init));
window.initLanguage = id => runtime.init_language(BigInt(id));

for (const path of files) {
	engine.copyToFS(`/${path}`, await (await fetch(`project/${path}`)).arrayBuffer());
}
await engine.start();
