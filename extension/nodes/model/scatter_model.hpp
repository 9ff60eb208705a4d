#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/model/scatter_lod.hpp"
#include "nodes/model/scene_reader.hpp"

#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/classes/shape3d.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// A level of detail as it is drawn: nothing in it is left open.
struct DrawnLod {
	double distance = 0.0;          ///< Meters; 0 for the first, ascending.
	godot::Ref<godot::Mesh> mesh;   ///< Never null.
	godot::Ref<godot::Mesh> shadow; ///< Null where the mesh casts its own shadow.
	std::int64_t cast_shadow = -1;  ///< ScatterLod::CastShadow.
	double density = 1.0;           ///< Share of the instances, 0 to 1.

	friend bool operator==(const DrawnLod &, const DrawnLod &) = default;
};

/// What stands at an instance, as an artist made it: levels of detail, each one mesh with all its materials, and shapes to bump into. Read from a scene, or
/// put together by hand. Emits `changed` whenever it looks otherwise.
class ScatterModel : public godot::Resource {
	GDCLASS(ScatterModel, godot::Resource)
	THICKET_GUARDED_METHODS

public:
	/// A scene to read LODs and shapes from; they follow it. One that has nothing to draw prints an error, and the model stays as it was. Null
	/// keeps what was read last, from then on to be edited by hand.
	void set_scene(const godot::Ref<godot::PackedScene> &p_scene);
	godot::Ref<godot::PackedScene> get_scene() const { return scene_; }

	/// The finest first; at most max_model_lods. Null entries are left out. Refused while there is a scene.
	void set_lods(const godot::TypedArray<ScatterLod> &p_lods);
	godot::TypedArray<ScatterLod> get_lods() const { return lods_; }

	/// What bodies bump into: boxes, spheres, capsules, cylinders and convex polygons, and where they are in the model's space. A shape
	/// without a transform stands at the origin. Refused while there is a scene.
	void set_shapes(const godot::TypedArray<godot::Shape3D> &p_shapes);
	godot::TypedArray<godot::Shape3D> get_shapes() const { return shapes_; }
	void set_shape_transforms(const godot::TypedArray<godot::Transform3D> &p_transforms);
	godot::TypedArray<godot::Transform3D> get_shape_transforms() const { return shape_transforms_; }

	/// Reads the scene anew, from its file if it has one. False, with an error, if that fails: the model stays as it was.
	bool reload();

	/// The mesh of an LOD as it is drawn; null for an index that is not there.
	godot::Ref<godot::Mesh> get_mesh(int64_t p_lod) const;

	/// The box around all LODs.
	godot::AABB get_aabb() const;

	/// What is drawn otherwise than the scene shows it, or left out: a sentence each.
	godot::PackedStringArray get_remarks() const { return remarks_; }

	/// What is drawn from which distance on. Empty if no LOD has a mesh.
	std::vector<DrawnLod> drawn_lods() const;
	std::vector<ModelShape> model_shapes() const;

	static constexpr int64_t max_model_lods = 8;
	static constexpr const char *class_name = "ScatterModel";

protected:
	static void _bind_methods();
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	bool read(const godot::Ref<godot::PackedScene> &p_scene);
	bool accept_edit(const char *p_property) const;
	void take_lods(const godot::TypedArray<ScatterLod> &p_lods);
	void watch_lods(bool p_watch);

	godot::Ref<godot::PackedScene> scene_;
	godot::TypedArray<ScatterLod> lods_;
	godot::TypedArray<godot::Shape3D> shapes_;
	godot::TypedArray<godot::Transform3D> shape_transforms_;
	godot::PackedStringArray remarks_;
};

/// A name for a scene in an error: its path, or what it is.
godot::String name_of(const godot::Ref<godot::PackedScene> &p_scene);

} // namespace thicket
