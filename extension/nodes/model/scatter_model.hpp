#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/common/scene_use.hpp"
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
#include <memory>
#include <vector>

namespace thicket {

/// A level of detail as it is drawn: nothing in it is left open.
struct DrawnLod {
	double distance = 0.0;          ///< Meters; 0 for the first, ascending.
	godot::Ref<godot::Mesh> mesh;   ///< Never null.
	godot::Ref<godot::Mesh> shadow; ///< Null where the mesh casts its own shadow.
	std::int64_t cast_shadow = -1;  ///< ScatterLod::CastShadow.
	LodLook look;

	friend bool operator==(const DrawnLod &, const DrawnLod &) = default;
};

/// What stands at an instance, as an artist made it: levels of detail, each one mesh with all its materials, and shapes to bump into. Read from a scene, or
/// put together by hand. Emits `changed` whenever it looks otherwise.
///
/// Any thread may set properties, as the engine's loader does: a setter keeps the scene and reads nothing of it. The main thread reads the scene when the
/// model is first needed: a node in steps (`read_step`), a getter all at once. On other threads, getters return what has been read so far.
class ScatterModel : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterModel, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// A scene to read LODs and shapes from; they follow it. An empty scene prints an error, and the property stays. If reading another one fails,
	/// an error is printed then, the model keeps what it has, and the property goes back to the scene that this is from; a model that has
	/// nothing keeps the scene, so that saving does not lose it. Null keeps what was read last, from then on to be edited by hand.
	void set_scene(const godot::Ref<godot::PackedScene> &p_scene);
	godot::Ref<godot::PackedScene> get_scene() const { return scene_; }

	/// Reads the next part of a scene that was set since the last reading. Returns false if there was nothing to read. Main thread only. Scripts in
	/// the scene may do anything meanwhile, with this model too.
	bool read_step();

	/// The finest first; at most max_model_lods. Null entries are left out. Refused while there is a scene.
	void set_lods(const godot::TypedArray<ScatterLod> &p_lods);
	godot::TypedArray<ScatterLod> get_lods();

	/// What bodies bump into: boxes, spheres, capsules, cylinders and convex polygons, and where they are in the model's space. A shape
	/// without a transform stands at the origin. Refused while there is a scene.
	void set_shapes(const godot::TypedArray<godot::Shape3D> &p_shapes);
	godot::TypedArray<godot::Shape3D> get_shapes();
	void set_shape_transforms(const godot::TypedArray<godot::Transform3D> &p_transforms);
	godot::TypedArray<godot::Transform3D> get_shape_transforms();

	/// Reads the scene anew, from its file if it has one. False, with an error, if that fails: the model stays as it was.
	bool reload();

	/// The mesh of an LOD as it is drawn; null for an index that is not there.
	godot::Ref<godot::Mesh> get_mesh(int64_t p_lod);

	/// The box around all LODs.
	godot::AABB get_aabb();

	/// What is drawn otherwise than the scene shows it, or left out: a sentence each.
	godot::PackedStringArray get_problems();

	/// Adds what the main thread reads along with the model.
	void add_used(SceneUse::List &r_used) const;

	/// What has been read so far. `drawn_lods` is what is drawn from which distance on, and empty if no LOD has a mesh; `problem` says why the
	/// last scene could not be read, as the rest of a sentence that names it, and is empty if it could.
	std::vector<DrawnLod> drawn_lods() const;
	std::vector<ModelShape> model_shapes() const;
	const godot::PackedStringArray &remarks() const { return remarks_; }
	const godot::String &problem() const { return problem_; }

	static constexpr int64_t max_model_lods = 8;
	static constexpr const char *class_name = "ScatterModel";

protected:
	static void _bind_methods();
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	/// What was set by hand since `unread_`: reading that leaves it alone.
	struct HandSet {
		bool lods = false;
		bool shapes = false;
		bool shape_transforms = false;
	};

	void read();
	bool take_over(const SceneReading &reading, const godot::Ref<godot::PackedScene> &p_scene);
	void finish_reading(const SceneReading &reading);
	bool accept_edit(const char *p_property) const;
	void take_lods(const godot::TypedArray<ScatterLod> &p_lods);
	void watch_lods(bool p_watch);

	godot::Ref<godot::PackedScene> scene_;
	godot::Ref<godot::PackedScene> source_; ///< That the LODs were read from; null for those made by hand.
	godot::Ref<godot::PackedScene> unread_; ///< To be read when the model is needed; null for none.
	std::shared_ptr<SceneReader> reader_;   ///< Of `unread_`; null until its first step.
	bool stepping_ = false;                 ///< A script in the scene may ask for the model that is being read.
	HandSet hand_set_;
	godot::String problem_;
	godot::TypedArray<ScatterLod> lods_;
	godot::TypedArray<godot::Shape3D> shapes_;
	godot::TypedArray<godot::Transform3D> shape_transforms_;
	godot::PackedStringArray remarks_;
};

/// A name for a scene in an error: its path, or what it is.
godot::String name_of(const godot::Ref<godot::PackedScene> &p_scene);

} // namespace thicket
