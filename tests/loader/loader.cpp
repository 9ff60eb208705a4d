// Loads a library of the extension on systems without an engine. Calls its entry point with a fake
// interface, lets it register its classes, creates one object of each, unregisters everything, and
// closes the library. Prints the registered members, one per line, so that two libraries can be
// compared. Fails if anything is missing.
//   loader LIBRARY [double]

#include "tests/loader/fake_engine.hpp"

#include <cstdio>
#include <string>

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace {

using namespace thicket::loader;

#ifdef _WIN32
void *open(const char *path) { return reinterpret_cast<void *>(LoadLibraryA(path)); }
void *find(void *library, const char *name) {
	return reinterpret_cast<void *>(GetProcAddress(static_cast<HMODULE>(library), name));
}
bool close(void *library) { return FreeLibrary(static_cast<HMODULE>(library)) != 0; }
std::string last_error() { return "error " + std::to_string(GetLastError()); }
#else
void *open(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
void *find(void *library, const char *name) { return dlsym(library, name); }
bool close(void *library) { return dlclose(library) == 0; }
std::string last_error() {
	const char *const text = dlerror();
	return text != nullptr ? text : "no reason given";
}
#endif

int fail(const std::string &message) {
	std::fprintf(stderr, "loader: %s\n", message.c_str());
	return 1;
}

/// Creates an instance of each class that is not abstract, and frees it.
void make_one_of_each() {
	for (const RegisteredClass &entry : record().classes) {
		if (entry.info.is_abstract) {
			continue;
		}
		void *const object = entry.info.create_instance_func(entry.info.class_userdata, false);
		entry.info.free_instance_func(entry.info.class_userdata, instance_of(object));
	}
}

void print() {
	for (const RegisteredClass &entry : record().classes) {
		std::printf("class %s of %s\n", entry.name.c_str(), entry.parent.c_str());
		for (const std::string &member : entry.members) {
			std::printf("%s: %s\n", entry.name.c_str(), member.c_str());
		}
	}
}

int run(void *library) {
	const auto entry_point = reinterpret_cast<GDExtensionInitializationFunction>(find(library, "thicket_library_init"));
	if (entry_point == nullptr) {
		return fail("the library has no thicket_library_init: " + last_error());
	}
	GDExtensionInitialization steps{};
	static int token = 0;
	if (!entry_point(get_proc_address, &token, &steps)) {
		return fail(record().errors.empty() ? "the entry point of the library failed" : record().errors.front());
	}
	const int first = steps.minimum_initialization_level;
	for (int level = first; level < GDEXTENSION_INITIALIZATION_EDITOR; ++level) {
		steps.initialize(steps.userdata, static_cast<GDExtensionInitializationLevel>(level));
	}
	make_one_of_each();
	print();
	for (int level = GDEXTENSION_INITIALIZATION_EDITOR - 1; level >= 0; --level) {
		steps.deinitialize(steps.userdata, static_cast<GDExtensionInitializationLevel>(level));
	}
	for (const RegisteredClass &entry : record().classes) {
		if (entry.registered) {
			return fail(entry.name + " is still registered");
		}
	}
	return record().errors.empty() ? 0 : fail(record().errors.front());
}

} // namespace

int main(int argc, char **argv) {
	if (argc < 2) {
		return fail("usage: loader LIBRARY [double]");
	}
	set_double_precision(argc > 2 && std::string(argv[2]) == "double");
	void *const library = open(argv[1]);
	if (library == nullptr) {
		return fail(std::string(argv[1]) + " cannot be loaded: " + last_error());
	}
	const int result = run(library);
	if (!close(library)) {
		return fail("the library cannot be closed: " + last_error());
	}
	if (result == 0) {
		std::printf("loaded and closed, %zu classes, %zu functions of the engine\n", record().classes.size(),
				record().functions.size());
	}
	return result;
}
