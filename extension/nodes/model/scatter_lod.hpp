#pragma once

#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace thicket {

/// Values of instance uniforms, by name.
using ShaderParameters = std::vector<std::pair<godot::StringName, godot::Variant>>;

/// How the renderer draws all instances of an LOD, whatever their meshes.
struct LodLook {
	double density = 1.0;                               ///< Share of the instances, 0 to 1.
	double transparency = 0.0;                          ///< As in GeometryInstance3D, 0 to 1.
	std::shared_ptr<const ShaderParameters> parameters; ///< Null if there are none. A change replaces the object.

	friend bool operator==(const LodLook &, const LodLook &) = default;
};

/// The look of a ScatterModel from a certain distance on: one of its LODs. Emits `changed` whenever a property is set, and whenever one of
/// its meshes changes.
class ScatterLod : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterLod, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// GeometryInstance3D.ShadowCastingSetting, and the layer's setting.
	enum CastShadow : std::int64_t {
		CAST_SHADOW_LAYER = -1,
		CAST_SHADOW_OFF,
		CAST_SHADOW_ON,
		CAST_SHADOW_DOUBLE_SIDED,
		CAST_SHADOW_SHADOWS_ONLY,
	};

	/// Null to use the mesh of the next finer LOD.
	void set_mesh(const godot::Ref<godot::Mesh> &p_mesh);
	godot::Ref<godot::Mesh> get_mesh() const { return mesh_; }

	/// Meters from a viewer, 0 to max_lod_distance. 0 chooses a distance that fits the size of the model. A model's
	/// first LOD is drawn from 0 meters on.
	void set_distance(double p_distance);
	double get_distance() const { return distance_; }

	void set_cast_shadow(CastShadow p_setting);
	CastShadow get_cast_shadow() const { return cast_shadow_; }

	/// The mesh that casts the shadow; null if the mesh itself casts it.
	void set_shadow_mesh(const godot::Ref<godot::Mesh> &p_mesh);
	godot::Ref<godot::Mesh> get_shadow_mesh() const { return shadow_mesh_; }

	/// Share of the instances that are drawn with this LOD, 0 to 1.
	void set_density(double p_density);
	double get_density() const { return look_.density; }

	/// As GeometryInstance3D.transparency, 0 to 1.
	void set_transparency(double p_transparency);
	double get_transparency() const { return look_.transparency; }

	/// Values of instance uniforms for the shaders of the mesh, by name.
	void set_instance_shader_parameters(const godot::Dictionary &p_parameters);
	godot::Dictionary get_instance_shader_parameters() const;

	void set_look(const LodLook &look);
	const LodLook &look() const { return look_; }

	static constexpr const char *class_name = "ScatterLod";

protected:
	static void _bind_methods();

private:
	void replace(godot::Ref<godot::Mesh> &r_own, const godot::Ref<godot::Mesh> &p_mesh);

	godot::Ref<godot::Mesh> mesh_;
	godot::Ref<godot::Mesh> shadow_mesh_;
	double distance_ = 0.0;
	LodLook look_;
	CastShadow cast_shadow_ = CAST_SHADOW_LAYER;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterLod::CastShadow)
