#include "nodes/common/precision.hpp"

#include <godot_cpp/core/defs.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

using namespace godot;

namespace thicket {

namespace {

template <class Function>
Function find(GDExtensionInterfaceGetProcAddress p_get_proc_address, const char *name) {
	return reinterpret_cast<Function>(reinterpret_cast<void *>(p_get_proc_address(name)));
}

/// Returns the size of the engine's real_t in bytes. Constructs a Vector3 in a buffer of 0xFF bytes
/// and counts the bytes that it sets to zero.
std::size_t engine_real_size(GDExtensionInterfaceGetProcAddress p_get_proc_address) {
	const auto get_constructor =
			find<GDExtensionInterfaceVariantGetPtrConstructor>(p_get_proc_address, "variant_get_ptr_constructor");
	alignas(16) std::array<unsigned char, 64> bytes;
	bytes.fill(0xFF);
	get_constructor(GDEXTENSION_VARIANT_TYPE_VECTOR3, 0)(bytes.data(), nullptr);
	return static_cast<std::size_t>(std::ranges::count(bytes, 0)) / 3;
}

std::string precision_name(std::size_t real_size) { return real_size == sizeof(double) ? "double" : "single"; }

} // namespace

bool fits_precision(GDExtensionInterfaceGetProcAddress p_get_proc_address) {
	const std::size_t real_size = engine_real_size(p_get_proc_address);
	if (real_size == sizeof(Vector3::x)) {
		return true;
	}
	const std::string engine_precision = precision_name(real_size);
	const std::string message = "This Thicket library was compiled for engines with " +
			precision_name(sizeof(Vector3::x)) + " precision, and this engine has " + engine_precision +
			" precision: add the library that `scons precision=" + engine_precision + " extension` builds.";
	const auto print = find<GDExtensionInterfacePrintError>(p_get_proc_address, "print_error");
	print(message.c_str(), __FUNCTION__, __FILE__, __LINE__, true);
	return false;
}

} // namespace thicket
