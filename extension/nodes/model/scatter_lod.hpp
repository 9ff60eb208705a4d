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

/// The renderer settings for all instances of an LOD, independent of the mesh.
struct LodAppearance {
	double density = 1.0; ///< The fraction of instances to draw, 0 to 1.
	/// The transparency, 0 to 1, like GeometryInstance3D.transparency.
	double transparency = 0.0;
	/// The values of the instance uniforms. Null if there are none. The object is immutable;
	/// changes replace it.
	std::shared_ptr<const ShaderParameters> parameters;

	friend bool operator==(const LodAppearance &, const LodAppearance &) = default;
};

/// An LOD of a ScatterModel: the mesh and settings to draw it with from a certain distance. Emits
/// `changed` when a property is set, and when one of its meshes changes.
class ScatterLod : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterLod, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// The values of GeometryInstance3D.ShadowCastingSetting, and a value that selects the layer's
	/// setting.
	enum CastShadow : std::int64_t {
		CAST_SHADOW_LAYER = -1,
		CAST_SHADOW_OFF,
		CAST_SHADOW_ON,
		CAST_SHADOW_DOUBLE_SIDED,
		CAST_SHADOW_SHADOWS_ONLY,
	};

	/// Sets the mesh. Null selects the mesh of the next finer LOD.
	void set_mesh(const godot::Ref<godot::Mesh> &p_mesh);
	godot::Ref<godot::Mesh> get_mesh() const { return mesh_; }

	/// Sets the distance from a viewer in meters at which this LOD begins, 0 to max_lod_distance.
	/// If it is 0, the size of the model determines the distance. The first LOD of a model always
	/// begins at 0.
	void set_distance(double p_distance);
	double get_distance() const { return distance_; }

	void set_cast_shadow(CastShadow p_setting);
	CastShadow get_cast_shadow() const { return cast_shadow_; }

	/// Sets the mesh that casts the shadow. Null means that the visible mesh casts it.
	void set_shadow_mesh(const godot::Ref<godot::Mesh> &p_mesh);
	godot::Ref<godot::Mesh> get_shadow_mesh() const { return shadow_mesh_; }

	/// Sets the fraction of instances to draw with this LOD, 0 to 1.
	void set_density(double p_density);
	double get_density() const { return appearance_.density; }

	/// Sets the transparency, 0 to 1, like GeometryInstance3D.transparency.
	void set_transparency(double p_transparency);
	double get_transparency() const { return appearance_.transparency; }

	/// Sets values of instance uniforms for the shaders of the mesh, by name.
	void set_instance_shader_parameters(const godot::Dictionary &p_parameters);
	godot::Dictionary get_instance_shader_parameters() const;

	void set_appearance(const LodAppearance &appearance);
	const LodAppearance &appearance() const { return appearance_; }

	static constexpr const char *class_name = "ScatterLod";

protected:
	static void _bind_methods();

private:
	void replace(godot::Ref<godot::Mesh> &r_mesh, const godot::Ref<godot::Mesh> &p_mesh);

	godot::Ref<godot::Mesh> mesh_;
	godot::Ref<godot::Mesh> shadow_mesh_;
	double distance_ = 0.0;
	LodAppearance appearance_;
	CastShadow cast_shadow_ = CAST_SHADOW_LAYER;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterLod::CastShadow)
