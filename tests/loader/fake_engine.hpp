#pragma once

// As much of the engine's interface as a library needs to load, register its classes, make one of each, and go: strings are
// strings, objects are numbers with a name, methods of the engine do nothing and answer with zeros.

#include <gdextension_interface.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace thicket::loader {

/// A class that the library has registered, as it told it.
struct RegisteredClass {
	std::string name;
	std::string parent;
	GDExtensionClassCreationInfo4 info{};
	std::vector<std::string> members; ///< In order: "method sample(2)", "property radius", "signal settled".
	bool registered = true;
};

/// What happened so far.
struct Record {
	std::vector<RegisteredClass> classes;
	std::vector<std::string> errors;       ///< What the library has printed, and what it did that no library may.
	std::map<std::string, bool> functions; ///< Functions that were asked for; true for those that this engine has.
	std::size_t objects = 0;               ///< Objects that live.
};

Record &record();

/// Whether the engine computes with double precision. Single by itself.
void set_double_precision(bool on);

/// What a library has given to an object that it made.
GDExtensionClassInstancePtr instance_of(void *object);

/// What a library gets from its engine. Null for a function that this one lacks.
GDExtensionInterfaceFunctionPtr get_proc_address(const char *name);

} // namespace thicket::loader
