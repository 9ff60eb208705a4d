#pragma once

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>

namespace thicket {

/// The properties lod_distances and lod_meshes with which release 0.2 saved the LODs of a layer: one row of meshes for each distance. They
/// are kept until `meshes` is known too, because a file may have its properties in any order.
class FormerLods {
public:
	/// Keeps a former property, and warns once. Returns false for any other name. Any thread.
	bool set(const godot::StringName &p_name, const godot::Variant &p_value);

	bool empty() const { return distances_.size() == 0 && meshes_.is_empty(); }

	/// True if there is a mesh for each of the entries at each of the distances.
	bool known(std::size_t entries) const;

	/// Returns the list with a ScatterModel in place of each entry that has LODs; these are added to those of the entry. As in release 0.2,
	/// incomplete rows are left out.
	godot::Array added_to(const godot::Array &p_entries) const;

private:
	godot::PackedFloat32Array distances_;
	godot::TypedArray<godot::Mesh> meshes_;
};

/// The five properties visibility_range_* with which release 0.2 limited from where to where tiles are drawn. Only the end has a successor,
/// view_distance. It is kept until the layer is first used, because a file may set view_distance later.
class FormerVisibility {
public:
	/// Keeps a former property, and warns once. Returns false for any other name. Any thread.
	bool set(const godot::StringName &p_name, const godot::Variant &p_value);

	/// A view distance, limited by the former end. Applies it once: a later view distance counts as it is.
	double limited(double view_distance);

private:
	double end_ = 0.0; ///< Meters; 0 if there is none.
};

} // namespace thicket
