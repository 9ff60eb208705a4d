#pragma once

#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/model/scatter_model.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <vector>

namespace thicket {

/// What stands at the instances of a layer: the entries of ScatterLayer.meshes, each a Mesh, a PackedScene, a ScatterModel or null, and what replaces
/// them with distance.
class LayerMeshes {
public:
	/// Takes over a list, on any thread: nothing of a mesh or a scene is read. False, with an error, for an entry of another kind and for an empty
	/// scene: then all stays as it was. Only where there was nothing before, as when a layer is being loaded, an empty scene stays in the
	/// list, so that saving does not lose it.
	bool set_entries(const godot::Array &p_entries);

	/// Scripts share the list, and may change it in place: true if they have since it was taken over.
	bool differs() const;

	/// Takes over such a change. False, with an error, if it is refused as by `set_entries`.
	bool take_changes() { return take(entries_); }

	/// Forgets such a change: scripts see a new list, with the entries that were taken over last.
	void restore();

	/// Reads the next part of a scene that was not read yet: see ScatterModel. Until then nothing is drawn for it. Returns false if all is read.
	bool read_step() const;

	/// As scripts see it.
	const godot::Array &entries() const { return entries_; }
	std::size_t size() const { return taken_.size(); }

	/// Whatever emits `changed` when an entry looks otherwise: meshes and models. No null among them.
	std::vector<godot::Object *> sources() const;

	/// Reads scenes anew whose files are among these. True if there were any.
	bool reload(const godot::PackedStringArray &p_paths);

	/// True if anything is drawn, of what is read so far.
	bool has_mesh() const;

	/// Fills in what is drawn, with a row for each distance at which an entry changes, and those distances. `p_meshes` and `p_distances` are
	/// ScatterLayer's lod_meshes and lod_distances. Distances beyond the first max_lods are left out.
	void draw(const godot::TypedArray<godot::Mesh> &p_meshes, const godot::PackedFloat32Array &p_distances,
			LayerDrawing &r_drawing, LodSettings &r_lod) const;

	/// The shapes of each entry; none for what is no model.
	std::vector<std::vector<BodyPart>> bodies() const;

	/// What is likely not meant, a sentence each.
	void add_problems(godot::PackedStringArray &r_problems) const;

	/// The model of an entry, which for a scene is the one that was made of it; null for a mesh.
	godot::Ref<ScatterModel> model(std::size_t entry) const { return taken_[entry].model; }

	/// The mesh of an entry near by; null for none, and while its scene is not read.
	godot::Ref<godot::Mesh> mesh(std::size_t entry) const;

private:
	struct Entry {
		godot::Ref<godot::Resource> resource; ///< Null for an empty entry.
		godot::Ref<ScatterModel> model;       ///< Null for meshes, and for empty scenes.
	};

	bool take(const godot::Array &p_entries);
	godot::Ref<ScatterModel> model_of(const godot::Ref<godot::PackedScene> &p_scene) const;
	std::vector<DrawnLod> lods_of(std::size_t entry, const godot::TypedArray<godot::Mesh> &p_meshes,
			const godot::PackedFloat32Array &p_distances) const;

	godot::Array entries_;
	std::vector<Entry> taken_; ///< What was taken over of them last.
};

} // namespace thicket
