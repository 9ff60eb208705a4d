#pragma once

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>

namespace thicket {

/// The properties lod_distances and lod_meshes, in which release 0.2 saved the LODs of a layer: one row of meshes for
/// each distance. Kept until `meshes` is known as well, because a file may have its properties in any order.
class FormerLods {
public:
	/// Keeps a former property, and warns once. Returns false for any other name. Any thread.
	bool set(const godot::StringName &p_name, const godot::Variant &p_value);

	bool empty() const { return distances_.size() == 0 && meshes_.is_empty(); }

	/// True if each of the distances has a mesh for each of the entries.
	bool known(std::size_t entries) const;

	/// Returns the list with a ScatterModel in place of each entry that has LODs. Adds the former LODs to those of the
	/// entry itself. Leaves out incomplete rows, as release 0.2 did.
	godot::Array added_to(const godot::Array &p_entries) const;

private:
	godot::PackedFloat32Array distances_;
	godot::TypedArray<godot::Mesh> meshes_;
};

/// The five properties visibility_range_*, with which release 0.2 limited the distances at which tiles are drawn. Only
/// the end has a successor, view_distance. It is kept until the layer is first used, because a file may set
/// view_distance later.
class FormerVisibility {
public:
	/// Keeps a former property, and warns once. Returns false for any other name. Any thread.
	bool set(const godot::StringName &p_name, const godot::Variant &p_value);

	/// Limits a view distance by the former end. Does so only once: a view distance that is set later counts as it is.
	double limited(double view_distance);

private:
	double end_ = 0.0; ///< Meters; 0 if there is none.
};

} // namespace thicket
