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

/// The entries of ScatterLayer.meshes, each a Mesh, a PackedScene, a ScatterModel or null.
class LayerMeshes {
public:
	/// Replaces the list, on any thread, without reading any mesh or scene. Returns false, with an error, if an entry
	/// is of a different kind or an empty scene; the list is then unchanged. One exception: if the list was empty
	/// before, as when a layer is loaded, an empty scene stays in the list, so that saving does not lose it.
	bool set_entries(const godot::Array &p_entries);

	/// True if scripts have changed the list in place since the last `set_entries` or `take_changes`. Scripts share the
	/// list.
	bool differs() const;

	/// Applies changes that scripts have made in place. Returns false, with an error, if they are refused as in
	/// `set_entries`.
	bool take_changes() { return take(entries_); }

	/// Discards changes that scripts have made in place: scripts get a new list with the last accepted entries.
	void restore();

	/// Reads the next part of a scene that is not fully read; see ScatterModel. A scene is not drawn until it is read.
	/// Returns false once all scenes are read.
	bool read_step() const;

	/// The list that scripts see.
	const godot::Array &entries() const { return entries_; }
	std::size_t size() const { return taken_.size(); }

	/// The objects whose `changed` signals report a change of an entry's appearance: meshes and models. Contains no
	/// null.
	std::vector<godot::Object *> sources() const;

	/// Rereads the scenes whose files are among these paths. Returns true if there were any.
	bool reload(const godot::PackedStringArray &p_paths);

	/// True if anything that is already read can be drawn.
	bool has_mesh() const;

	/// Fills in the distances at which any entry changes, and the meshes to draw, with one row for each distance.
	/// Leaves out distances beyond the first max_lods.
	void draw(LayerDrawing &r_drawing, LodSettings &r_lod) const;

	/// The shapes of each entry. Entries that are not models have none.
	std::vector<std::vector<BodyPart>> bodies() const;

	/// Adds one sentence for each likely mistake.
	void add_problems(godot::PackedStringArray &r_problems) const;

	/// The model of an entry. For a scene, the model that was created from it; null for a mesh.
	godot::Ref<ScatterModel> model(std::size_t entry) const { return taken_[entry].model; }

	/// The entry as scripts set it; null for an empty entry.
	godot::Ref<godot::Resource> resource(std::size_t entry) const { return taken_[entry].resource; }

	/// The mesh of an entry's finest LOD. Null if the entry has none, or while its scene has not been read.
	godot::Ref<godot::Mesh> mesh(std::size_t entry) const;

private:
	struct Entry {
		godot::Ref<godot::Resource> resource; ///< Null for an empty entry.
		godot::Ref<ScatterModel> model;       ///< Null for meshes, and for empty scenes.
	};

	bool take(const godot::Array &p_entries);
	godot::Ref<ScatterModel> model_of(const godot::Ref<godot::PackedScene> &p_scene) const;
	std::vector<DrawnLod> lods_of(std::size_t entry) const;

	godot::Array entries_;
	std::vector<Entry> taken_; ///< The entries of the list when it was last accepted.
};

} // namespace thicket
