#pragma once

#include "core/impostor/impostor.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/color.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace thicket {

/// Renders views of triangles from all directions on the CPU: the core's bake_impostor for scripts.
/// The addon's impostor.gd creates a mesh with a material from the views. Any thread may call any
/// method. A bake uses the surfaces and settings at the time it began.
class ScatterImpostorBaker : public godot::RefCounted {
	GDCLASS(ScatterImpostorBaker, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	static constexpr const char *class_name = "ScatterImpostorBaker";

	/// The values of CulledSide, for scripts.
	enum CullMode : std::int64_t {
		CULL_BACK,
		CULL_FRONT,
		CULL_DISABLED,
	};

	/// The values of VertexColors, for scripts.
	enum VertexColorMode : std::int64_t {
		VERTEX_COLOR_UNUSED,
		VERTEX_COLOR_LINEAR,
		VERTEX_COLOR_SRGB,
	};

	// These setters set the ImpostorSettings. A value that would make the settings invalid prints
	// an error and leaves them unchanged.
	void set_frames(int64_t p_frames);
	int64_t get_frames() const;
	void set_frame_size(int64_t p_frame_size);
	int64_t get_frame_size() const;
	void set_samples(int64_t p_samples);
	int64_t get_samples() const;
	void set_full_sphere(bool p_full_sphere);
	bool is_full_sphere() const;

	/// Adds the triangles of a surface. `p_arrays` are as returned by Mesh.surface_get_arrays;
	/// `p_transform` is applied to them. `p_albedo` is in sRGB, as in the engine's materials. If
	/// ImpostorSurface::check rejects the data, an array has the wrong type or the image cannot be
	/// read, prints an error, adds nothing and returns ERR_INVALID_DATA.
	godot::Error add_surface(const godot::Array &p_arrays, const godot::Transform3D &p_transform,
			const godot::Color &p_albedo, const godot::Ref<godot::Image> &p_texture, double p_alpha_threshold,
			CullMode p_cull_mode, VertexColorMode p_vertex_colors);

	/// Removes all surfaces, but keeps the result of the last bake.
	void clear();

	/// Renders all views, which takes seconds. Returns ERR_BUSY while another call bakes, ERR_SKIP
	/// after `cancel`, ERR_INVALID_DATA if there is nothing to draw, or ERR_OUT_OF_MEMORY. After an
	/// error, the previous result stays available.
	godot::Error bake();

	/// Cancels the bake in progress, which ends after at most one more view.
	void cancel();

	/// Returns the progress of the current or last bake, 0 to 1.
	double get_progress() const { return progress_; }

	// These methods return the result of the last bake. Before the first bake, images are null and
	// numbers are 0.
	godot::Ref<godot::Image> get_albedo_image() const;
	godot::Ref<godot::Image> get_normal_image() const;
	godot::AABB get_box() const;
	godot::Vector3 get_center() const;
	double get_radius() const;

protected:
	static void _bind_methods();

private:
	ImpostorSettings current_settings() const;
	void apply_settings(const ImpostorSettings &p_settings);
	std::shared_ptr<const SurfaceTexture> texture_of(const godot::Ref<godot::Image> &p_image);
	godot::Ref<godot::Image> image_of(const std::vector<std::uint8_t> &p_atlas) const;

	mutable std::mutex mutex_; ///< Guards all following members except the atomic ones.
	ImpostorSettings settings_;
	std::vector<ImpostorSurface> surfaces_;
	/// The textures that have been read, keyed by the image's object ID.
	std::map<std::uint64_t, std::shared_ptr<const SurfaceTexture>> textures_;
	Impostor impostor_;

	std::atomic<bool> busy_ = false;
	std::atomic<bool> cancelled_ = false; ///< Set by `cancel`; ends the bake in progress.
	std::atomic<double> progress_ = 0.0;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterImpostorBaker::CullMode)
VARIANT_ENUM_CAST(thicket::ScatterImpostorBaker::VertexColorMode)
