#pragma once

// Implements the part of the GDExtension interface that a library needs to load, register its
// classes, create one object of each, and unload. Strings have content and objects have a class
// name, but the engine's methods do nothing.

#include <gdextension_interface.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace thicket::loader {

/// A class that the library has registered, and its members.
struct RegisteredClass {
	std::string name;
	std::string parent;
	GDExtensionClassCreationInfo4 info{};
	/// The members in order of registration: "method sample(2)", "property radius", "signal
	/// settled".
	std::vector<std::string> members;
	bool registered = true;
};

/// Everything that the fake engine has recorded so far.
struct Record {
	std::vector<RegisteredClass> classes;
	std::vector<std::string> errors; ///< Errors that the library printed, and its violations of the interface.
	/// The functions that the library requested. The value is true if this engine implements the
	/// function.
	std::map<std::string, bool> functions;
	std::size_t objects = 0; ///< The number of live objects.
};

Record &record();

/// Sets whether the engine uses double precision. The default is single precision.
void set_double_precision(bool on);

/// Returns the instance that the library attached to an object.
GDExtensionClassInstancePtr instance_of(void *object);

/// Returns a function of the engine, or a function that does nothing if this engine lacks it.
GDExtensionInterfaceFunctionPtr get_proc_address(const char *name);

} // namespace thicket::loader
