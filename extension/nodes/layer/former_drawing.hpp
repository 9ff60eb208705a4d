#pragma once

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>

namespace thicket {

/// The properties lod_distances and lod_meshes, in which release 0.2 saved the LODs of a layer: one
/// row of meshes per distance. Their values are kept until `meshes` is loaded, because the
/// properties in a file may have any order.
class FormerLods {
public:
	/// Stores the value of one of these properties and warns once. Returns false for any other
	/// name. Any thread may call this method.
	bool set(const godot::StringName &p_name, const godot::Variant &p_value);

	bool empty() const { return distances_.size() == 0 && meshes_.is_empty(); }

	/// Returns true if each distance has a mesh for each of `entries` entries.
	bool is_complete(std::size_t entries) const;

	/// Returns a copy of the list in which a ScatterModel replaces each entry that has stored LODs.
	/// The model has the entry's LODs and the stored ones. Skips incomplete rows, as release 0.2
	/// did.
	godot::Array apply_to(const godot::Array &p_entries) const;

private:
	godot::PackedFloat32Array distances_;
	godot::TypedArray<godot::Mesh> meshes_;
};

/// The five properties visibility_range_*, which limited the distances at which release 0.2 drew
/// tiles. Only visibility_range_end has a replacement, view_distance. Its value is kept until the
/// layer is first used, because a file may set view_distance later.
class FormerVisibility {
public:
	/// Stores the value of one of these properties and warns once. Returns false for any other
	/// name. Any thread may call this method.
	bool set(const godot::StringName &p_name, const godot::Variant &p_value);

	/// Limits a view distance (meters) by the stored visibility_range_end and discards that value,
	/// so a view distance that is set later is not limited.
	double limit(double view_distance);

private:
	double end_ = 0.0; ///< The stored visibility_range_end in meters; 0 if there is none.
};

} // namespace thicket
