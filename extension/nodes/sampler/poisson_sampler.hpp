#pragma once

#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/point_set.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/sampler/poisson_points.hpp"
#include "nodes/sampler/poisson_surface_points.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace thicket {

/// The script API of the samplers. Returns the points of one infinite Poisson-disk set in a
/// rectangle. Can also fill whole domains with a method of White, Cline and Egbert (2007), and
/// cover surfaces. Runs one call at a time: a second call, from another thread or from a progress
/// callable, prints an error and returns nothing. Separate objects are independent, and equal
/// settings produce bit-identical results.
class PoissonSampler : public godot::RefCounted, public ThreadGuarded {
	GDCLASS(PoissonSampler, godot::RefCounted)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "PoissonSampler";

	/// The method that `sample_domain` uses to fill a rectangle. All methods except the first
	/// correspond to DomainMethod.
	enum Method : std::int64_t {
		METHOD_TILES, ///< A window of the infinite set, with the same points as `sample`.
		METHOD_NAIVE,
		METHOD_HIERARCHICAL,
		METHOD_ACCUMULATOR,
		METHOD_WAVEFRONT,
	};

	/// Sets the seed, any 64-bit number. A different seed selects a different set of points.
	void set_seed(int64_t p_seed);
	int64_t get_seed() const;

	/// Sets the minimum distance between any two points in meters, from min_radius to max_radius.
	/// Other values print an error and are ignored.
	void set_radius(double p_radius);
	double get_radius() const;

	/// Sets the number of levels of the progressive order, 1 to max_levels. Other values print an
	/// error and are ignored. Used by all calls except `sample_domain` with a method other than
	/// METHOD_TILES.
	void set_progressive_levels(int64_t p_levels);
	int64_t get_progressive_levels() const;

	/// Sets the method of `sample_domain`. Numbers that are not a Method print an error and are
	/// ignored.
	void set_method(Method p_method);
	Method get_method() const;

	/// Sets DomainRequest::toroidal: whether the points also keep their distance across opposite
	/// edges. With METHOD_TILES, `sample_domain` rejects true.
	void set_toroidal(bool p_toroidal);
	bool is_toroidal() const;

	/// Sets whether `sample_domain` uses DomainSampler<double> rather than DomainSampler<float>.
	/// METHOD_TILES ignores this setting.
	void set_double_precision(bool p_double_precision);
	bool is_double_precision() const;

	/// Sets DomainRequest::cell_size in radii, 0 to max_cell_size. Other values print an error and
	/// are ignored.
	void set_cell_size(double p_cell_size);
	double get_cell_size() const;

	/// Returns the points of the infinite set in a half-open rectangle in meters, with positions in
	/// single precision. If the rectangle is invalid, prints an error and returns no points. Never
	/// returns null.
	godot::Ref<PoissonPoints> sample(const godot::Rect2 &p_rect);

	/// Returns points like `sample`, for the rectangle [min, max). The positions are in double
	/// precision, so they are exact at any distance from the origin.
	godot::Ref<PoissonPoints> sample_exact(double p_min_x, double p_min_y, double p_max_x, double p_max_y);

	/// Fills a rectangle in meters with one set, using `method`. Adds the rectangle's corner to the
	/// core's positions and rounds the sum once to single precision, down if it would reach the far
	/// edge. Calls `p_progress` as described at ScriptProgress. If DomainRequest or PointSet
	/// rejects the request, prints an error and returns no points. Also returns none if the call is
	/// canceled.
	godot::PackedVector2Array sample_domain(const godot::Rect2 &p_rect, const godot::Callable &p_progress);

	/// Fills a rectangle like `sample_domain`, for the rectangle [min, max). The points have
	/// positions in double precision but neither IDs nor ranks.
	godot::Ref<PoissonPoints> sample_domain_exact(
			double p_min_x, double p_min_y, double p_max_x, double p_max_y, const godot::Callable &p_progress);

	/// Returns points on the triangles of a mesh after `p_transform`, in meters. Returns only those
	/// in the half-open window, unless the window is AABB(). If the call is invalid, prints an
	/// error and returns no points. Never returns null.
	godot::Ref<PoissonSurfacePoints> sample_surface(
			const godot::Ref<godot::Mesh> &p_mesh, const godot::Transform3D &p_transform, const godot::AABB &p_window);

	/// Returns points like `sample_surface`, for an array with three corners per triangle, as
	/// returned by Mesh.get_faces.
	godot::Ref<PoissonSurfacePoints> sample_faces(
			const godot::PackedVector3Array &p_faces, const godot::AABB &p_window);

	/// Ends the call in progress within 50 milliseconds, plus the time that the system takes to
	/// free a large workspace. That call then returns no points. Any thread and any progress
	/// callable may call this method. Does not affect later calls.
	void cancel();

	/// Returns the statistics of the last completed `sample_domain` or `sample_domain_exact`; see
	/// DomainStats.
	godot::Dictionary get_stats() const;

protected:
	static void _bind_methods();

private:
	/// One call in progress. The call is rejected if the sampler is already running another one.
	/// Keeps the sampler alive even if scripts release it during the call.
	class CallScope {
	public:
		CallScope(PoissonSampler *p_sampler, const char *p_method);
		~CallScope();
		CallScope(const CallScope &) = delete;
		CallScope &operator=(const CallScope &) = delete;

		bool is_granted() const { return is_granted_; }

	private:
		godot::Ref<PoissonSampler> sampler_;
		bool is_granted_;
	};

	bool try_set(const PointSet &p_set);
	struct Faces;
	static Status read_mesh(
			const godot::Ref<godot::Mesh> &p_mesh, const godot::Transform3D &p_transform, Faces &r_faces);
	/// Samples the triangles that `read` collects. `p_property` names them in error messages.
	godot::Ref<PoissonSurfacePoints> sample_triangles(const CallScope &p_scope, const char *p_property,
			const godot::AABB &p_window, bool is_mirrored, const std::function<Status(Faces &r_faces)> &read);
	std::span<const SamplePoint> fetch(const CallScope &p_scope, const Rect &p_rect);
	DomainRequest domain_request(const glm::dvec2 &p_size) const;
	void report_domain(const DomainRequest &p_request, Status p_status) const;

	/// Fills the domain and passes the points to the writer. If the request is rejected or
	/// canceled, the writer ends up empty.
	template <typename Writer>
	void write_domain(const CallScope &p_scope, const Rect &p_rect, const glm::dvec2 &p_size,
			const godot::Callable &p_progress, Writer &r_writer);
	template <typename Writer>
	Status write_by_method(const Rect &p_rect, const DomainRequest &p_request, const Progress &p_progress,
			Writer &r_writer, DomainStats &r_stats);
	template <typename Writer>
	Status write_tiles(const Rect &p_rect, const Progress &p_progress, Writer &r_writer, DomainStats &r_stats);

	PointSet set_;
	Method method_ = METHOD_TILES;
	bool toroidal_ = false;
	bool double_precision_ = false;
	double cell_size_ = 0.0;

	TileSampler sampler_;
	std::vector<SamplePoint> points_; ///< The points of the last call; kept to reuse the memory.
	DomainStats stats_;
	std::atomic<bool> is_busy_ = false;
	std::atomic<bool> is_cancelled_ = false; ///< Cancels the call in progress.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::PoissonSampler::Method)
