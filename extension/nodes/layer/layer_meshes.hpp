#pragma once

#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/model/scatter_model.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>

#include <cstddef>
#include <vector>

namespace thicket {

/// The entries of ScatterLayer.meshes. Each is a Mesh, a PackedScene, a ScatterModel or null.
class LayerMeshes {
public:
	/// Replaces the list without reading any mesh or scene. Any thread may call this method. If an
	/// entry has another type or is an empty scene, prints an error, leaves the list unchanged and
	/// returns false. There is one exception: if the list was empty, as when a layer is loaded,
	/// keeps an empty scene. Saving then does not lose the scene.
	bool set_entries(const godot::Array &p_entries);

	/// Returns true if scripts, which share the list, have changed it in place since the last call
	/// to `set_entries` or `take_changes`.
	bool differs() const;

	/// Applies changes that scripts have made in place. If they are invalid (see `set_entries`),
	/// prints an error and returns false.
	bool take_changes() { return take(entries_); }

	/// Discards changes that scripts have made in place. From then on, scripts get a new list with
	/// the last accepted entries.
	void restore();

	/// Reads the next part of a scene that is not fully read (see ScatterModel). A scene is not
	/// drawn until it is read. Returns false when all scenes are read.
	bool read_step() const;

	/// Returns the list that scripts see.
	const godot::Array &entries() const { return entries_; }
	std::size_t size() const { return accepted_entries_.size(); }

	/// Returns the meshes and models of all entries, which emit `changed` when their appearance
	/// changes. Contains no nulls.
	std::vector<godot::Object *> sources() const;

	/// Rereads the scenes whose files are among these paths. Returns true if there are any.
	bool reload(const godot::PackedStringArray &p_paths);

	/// Returns true if any entry that has been read has a mesh.
	bool has_mesh() const;

	/// Sets the distances at which any entry changes its LOD, and the meshes to draw, one row per
	/// distance. Only the first max_lods distances are used.
	void draw(LayerDrawing &r_drawing, LodSettings &r_lod) const;

	/// Returns the collision shapes of each entry. Meshes have none.
	std::vector<std::vector<BodyPart>> bodies() const;

	/// Adds one message for each likely mistake to `r_problems`.
	void add_problems(godot::PackedStringArray &r_problems) const;

	/// Returns the model of an entry: the entry itself, or the model created from its scene.
	/// Returns null for a mesh.
	godot::Ref<ScatterModel> model(std::size_t entry) const { return accepted_entries_[entry].model; }

	/// Returns the entry as it was set; null for an empty entry.
	godot::Ref<godot::Resource> resource(std::size_t entry) const { return accepted_entries_[entry].resource; }

	/// Returns the mesh of an entry's finest LOD. Returns null if the entry has none or if its
	/// scene has not been read yet.
	godot::Ref<godot::Mesh> mesh(std::size_t entry) const;

private:
	struct Entry {
		godot::Ref<godot::Resource> resource; ///< The entry as it was set; null for an empty entry.
		godot::Ref<ScatterModel> model;       ///< The model to draw; null for meshes and for empty scenes.
	};

	bool take(const godot::Array &p_entries);
	godot::Ref<ScatterModel> model_of(const godot::Ref<godot::PackedScene> &p_scene) const;
	std::vector<DrawnLod> lods_of(std::size_t entry) const;

	godot::Array entries_;
	std::vector<Entry> accepted_entries_; ///< The entries of the list when it was last accepted.
};

} // namespace thicket
