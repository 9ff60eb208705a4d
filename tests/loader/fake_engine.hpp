#pragma once

// The part of the engine's interface that a library needs to load, register its classes, create one object of each, and
// unload. Strings are real strings, objects are numbers with a name, and methods of the engine do nothing and return
// zeros.

#include <gdextension_interface.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace thicket::loader {

/// A class that the library has registered, with its reported members.
struct RegisteredClass {
	std::string name;
	std::string parent;
	GDExtensionClassCreationInfo4 info{};
	std::vector<std::string> members; ///< In order: "method sample(2)", "property radius", "signal settled".
	bool registered = true;
};

/// Everything recorded so far.
struct Record {
	std::vector<RegisteredClass> classes;
	std::vector<std::string> errors;       ///< Errors printed by the library, and its violations of the interface.
	std::map<std::string, bool> functions; ///< Functions that the library requested. True if this engine has them.
	std::size_t objects = 0;               ///< Objects alive.
};

Record &record();

/// Sets whether the engine uses double precision. The default is single.
void set_double_precision(bool on);

/// The instance that a library assigned to an object that it created.
GDExtensionClassInstancePtr instance_of(void *object);

/// Looks up a function of the engine. Null if this engine lacks it.
GDExtensionInterfaceFunctionPtr get_proc_address(const char *name);

} // namespace thicket::loader
