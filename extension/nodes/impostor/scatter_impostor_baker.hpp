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

/// Renders pictures of triangles from all directions, on the processor: bake_impostor for scripts. The addon's
/// impostor.gd creates a mesh with a material from them. Any thread may call any method. A bake uses the surfaces and
/// settings as they were when it began.
class ScatterImpostorBaker : public godot::RefCounted {
	GDCLASS(ScatterImpostorBaker, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	static constexpr const char *class_name = "ScatterImpostorBaker";

	/// CulledSide, for scripts.
	enum CullMode : std::int64_t {
		CULL_BACK,
		CULL_FRONT,
		CULL_DISABLED,
	};

	/// VertexColors, for scripts.
	enum VertexColorMode : std::int64_t {
		VERTEX_COLOR_UNUSED,
		VERTEX_COLOR_LINEAR,
		VERTEX_COLOR_SRGB,
	};

	// ImpostorSettings. A value that would make the settings invalid is ignored with an error.
	void set_frames(int64_t p_frames);
	int64_t get_frames() const;
	void set_frame_size(int64_t p_frame_size);
	int64_t get_frame_size() const;
	void set_samples(int64_t p_samples);
	int64_t get_samples() const;
	void set_full_sphere(bool p_full_sphere);
	bool is_full_sphere() const;

	/// Adds the triangles of a mesh's surface, from the engine's own arrays, with a transform applied. `p_albedo` is in
	/// sRGB, as in the engine's materials. Adds nothing and returns ERR_INVALID_DATA, with an error, for data that
	/// ImpostorSurface::check refuses, for arrays of other types, and for an image that cannot be read.
	godot::Error add_surface(const godot::Array &p_arrays, const godot::Transform3D &p_transform,
			const godot::Color &p_albedo, const godot::Ref<godot::Image> &p_texture, double p_alpha_threshold,
			CullMode p_cull_mode, VertexColorMode p_vertex_colors);

	/// Removes all surfaces. The result of the last bake stays.
	void clear();

	/// Bakes, which takes seconds; the result is available afterwards. Returns ERR_BUSY while another call bakes,
	/// ERR_SKIP after `cancel`, ERR_INVALID_DATA if there is nothing to draw, or ERR_OUT_OF_MEMORY. In these cases the
	/// previous result stays available.
	godot::Error bake();

	/// Ends the bake in progress, within one picture.
	void cancel();

	/// The progress of the current or the last bake: 0 to 1.
	double get_progress() const { return progress_; }

	// The result; null and empty before the first bake.
	godot::Ref<godot::Image> get_albedo_image() const;
	godot::Ref<godot::Image> get_normal_image() const;
	godot::AABB get_box() const;
	godot::Vector3 get_center() const;
	double get_radius() const;

protected:
	static void _bind_methods();

private:
	ImpostorSettings current() const;
	void try_set(const ImpostorSettings &p_settings);
	std::shared_ptr<const SurfaceTexture> texture_of(const godot::Ref<godot::Image> &p_image);
	godot::Ref<godot::Image> image_of(const std::vector<std::uint8_t> &p_atlas) const;

	mutable std::mutex mutex_; ///< Guards all following members but the last three.
	ImpostorSettings settings_;
	std::vector<ImpostorSurface> surfaces_;
	std::map<std::uint64_t, std::shared_ptr<const SurfaceTexture>> textures_; ///< By the images' instance IDs.
	Impostor impostor_;

	std::atomic<bool> busy_ = false;
	std::atomic<bool> cancelled_ = false; ///< Cancels the call in progress.
	std::atomic<double> progress_ = 0.0;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterImpostorBaker::CullMode)
VARIANT_ENUM_CAST(thicket::ScatterImpostorBaker::VertexColorMode)
