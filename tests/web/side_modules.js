// Attaches WebAssembly side modules to an engine that was built without dynamic linking. Godot's web build with Extensions Support
// does the same with emscripten's dynamic linker, which a build without that option lacks.
//
// A side module imports the engine's memory and its table of functions. It needs a part of each, whose size its section "dylink.0"
// specifies. Its addresses are relative to the beginning of these parts. A module may call functions of the engine and of modules
// that were attached before it.

// The size of the stack that all side modules share. The engine does not export the pointer to its own stack. Two stacks work, because
// calls are nested: each module only moves its own pointer.
const STACK_BYTES = 4 << 20;

// Reads an unsigned LEB128 number. Returns it and the offset of the next byte.
function readNumber(bytes, at) {
	let number = 0;
	for (let shift = 0; ; shift += 7) {
		const byte = bytes[at++];
		number += (byte & 127) * 2 ** shift;
		if (byte < 128) {
			return [number, at];
		}
	}
}

// Returns a copy of an engine's code whose table of functions may grow. The linker has set the table's maximum to its size. The new
// maximum is the largest number with the same number of bytes, so no other byte changes.
export function withGrowingTable(bytes) {
	const TABLE_SECTION = 4;
	for (let at = 8, size, section; at < bytes.length; at += size) {
		section = bytes[at];
		[size, at] = readNumber(bytes, at + 1);
		if (section !== TABLE_SECTION) {
			continue;
		}
		const [count, type] = readNumber(bytes, at);
		const [, maximum] = readNumber(bytes, type + 2);
		const [, end] = readNumber(bytes, maximum);
		if (count !== 1 || bytes[type + 1] !== 1 || end !== at + size) {
			throw new Error("the engine must have one table with a maximum");
		}
		const copy = bytes.slice();
		copy.fill(255, maximum, end - 1);
		copy[end - 1] = 127;
		return copy;
	}
	throw new Error("the engine has no table");
}

// Returns the sizes of a side module's memory and table, and the alignment of its memory, in bytes. The first entry of the section has
// these numbers.
function needsOf(module) {
	const [section] = WebAssembly.Module.customSections(module, "dylink.0");
	const bytes = new Uint8Array(section);
	let at = 2;
	const read = () => {
		let number;
		[number, at] = readNumber(bytes, at);
		return number;
	};
	return {memory: read(), alignment: 2 ** read(), table: read()};
}

export class SideModules {
	// `engine` has the exports of the engine's instance, and `others` has functions in JavaScript.
	constructor(engine, others) {
		this.engine = engine;
		this.table = engine.__indirect_function_table;
		this.functions = {...others, ...engine};
		this.addresses = {};
		this.stack = new WebAssembly.Global({value: "i32", mutable: true}, this.zeroed(STACK_BYTES, 16) + STACK_BYTES);
	}

	// Allocates memory of the engine, filled with zeros. Nothing frees it.
	zeroed(bytes, alignment) {
		const start = Math.ceil(this.engine.malloc(bytes + alignment) / alignment) * alignment;
		new Uint8Array(this.engine.memory.buffer).fill(0, start, start + bytes);
		return start;
	}

	// Returns the index in the table of a function that WebAssembly exports.
	indexOf(called) {
		this.table.set(this.table.grow(1), called);
		return this.table.length - 1;
	}

	// Attaches a compiled side module, runs its static constructors and returns its exports.
	async attach(module) {
		const needs = needsOf(module);
		const base = this.zeroed(needs.memory, needs.alignment);
		const addresses = {}; // The addresses of data that the module uses.
		const indices = {}; // The indices of functions whose address the module uses.
		const env = {
			memory: this.engine.memory,
			__indirect_function_table: this.table,
			__stack_pointer: this.stack,
			__memory_base: new WebAssembly.Global({value: "i32"}, base),
			__table_base: new WebAssembly.Global({value: "i32"}, this.table.grow(needs.table)),
		};
		let exports;
		const own = new Set(WebAssembly.Module.exports(module).map(each => each.name));
		const missing = [];
		for (const {module: space, name, kind} of WebAssembly.Module.imports(module)) {
			if (space === "GOT.mem") {
				addresses[name] = new WebAssembly.Global({value: "i32", mutable: true}, this.addresses[name] ?? 0);
			} else if (space === "GOT.func") {
				indices[name] = new WebAssembly.Global({value: "i32", mutable: true}, 0);
			} else if (kind === "function") {
				// A module also imports its own weak functions, which an earlier module may replace.
				env[name] = this.functions[name] ?? (own.has(name) ? (...values) => exports[name](...values) : undefined);
				if (!env[name]) {
					missing.push(name);
				}
			}
		}
		if (missing.length) {
			throw new Error("nothing exports " + missing.join(", "));
		}
		const imports = {env, "GOT.mem": addresses, "GOT.func": indices, wasi_snapshot_preview1: env};
		({exports} = await WebAssembly.instantiate(module, imports));
		for (const [name, value] of Object.entries(exports)) {
			if (value instanceof WebAssembly.Global) {
				this.addresses[name] ??= base + value.value;
			} else {
				this.functions[name] ??= value;
			}
		}
		for (const [name, global] of Object.entries(addresses)) {
			global.value = this.addresses[name] ?? 0;
		}
		for (const [name, global] of Object.entries(indices)) {
			global.value = this.functions[name] ? this.indexOf(this.functions[name]) : 0;
		}
		exports.__wasm_apply_data_relocs?.();
		exports.__wasm_call_ctors?.();
		return exports;
	}
}
