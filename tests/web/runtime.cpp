// A side module between the engine and our library. It is linked with the C and C++ libraries, and contains:
// - functions of the C library that our library imports, and that exist neither in the engine's exports nor in the static libraries
// - an entry point, through which GDScript learns the names of our classes

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

extern "C" {

void *emscripten_builtin_memalign(size_t alignment, size_t size); // The engine's.

// The C library's functions for blocks of memory are weak, so calls of them would leave the module. These use WebAssembly's instructions.
void *memcpy(void *to, const void *from, size_t size) { return __builtin_memcpy(to, from, size); }

void *memmove(void *to, const void *from, size_t size) { return __builtin_memmove(to, from, size); }

void *memset(void *to, int value, size_t size) { return __builtin_memset(to, value, size); }

int posix_memalign(void **made, size_t alignment, size_t size) {
	*made = emscripten_builtin_memalign(alignment, size);
	return *made == nullptr ? ENOMEM : 0;
}

void *calloc(size_t count, size_t size) {
	if (size != 0 && count > static_cast<size_t>(-1) / size) {
		return nullptr;
	}
	void *made = malloc(count * size);
	return made == nullptr ? nullptr : memset(made, 0, count * size);
}

// The name by which the C library calls calloc.
void *__libc_calloc(size_t count, size_t size) { return calloc(count, size); }

// Copies as many bytes as the new block has, because only the engine's allocator knows the size of the old one. The values of the bytes
// behind the old block do not matter.
void *realloc(void *old, size_t size) {
	void *made = malloc(size);
	if (made == nullptr || old == nullptr) {
		return made;
	}
	const size_t readable = __builtin_wasm_memory_size(0) * 65536 - reinterpret_cast<size_t>(old);
	memcpy(made, old, size < readable ? size : readable);
	free(old);
	return made;
}

// The library is compiled without exceptions, as the engine is. An exception of the C++ library ends the program.
[[noreturn]] void __cxa_throw(void * /*thrown*/, void * /*type*/, void (* /*destructor*/)(void *)) { abort(); }

using GetProcAddress = void (*(*)(const char *name))();
using EntryPoint = uint8_t (*)(GetProcAddress get_proc_address, void *library, void *initialization);

static GetProcAddress functions_of_engine = nullptr;
static EntryPoint entry_point_of_library = nullptr;

static uint8_t enter(GetProcAddress get_proc_address, void *library, void *initialization) {
	functions_of_engine = get_proc_address;
	return entry_point_of_library(get_proc_address, library, initialization);
}

static EntryPoint entry_point = enter;

// Returns the address of the entry point that the engine must call instead of the library's.
EntryPoint *wrap_entry_point(EntryPoint wrapped) {
	entry_point_of_library = wrapped;
	return &entry_point;
}

// Calls ScriptLanguage::init of an engine's script language, which lists all classes by name. An engine without an editor lists them only
// once, before it can load a library in this way.
void init_language(uint64_t id) {
	const auto get_instance = reinterpret_cast<void *(*)(uint64_t)>(functions_of_engine("object_get_instance_from_id"));
	void *language = get_instance(id);
	constexpr int INIT =
			23; // The index in the table of virtual functions, after 20 functions of Object, its two destructors, and get_name.
	(*static_cast<void (***)(void *)>(language))[INIT](language);
}
}
