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

/// The samplers for scripts: windows onto one infinite Poisson-disk set, and whole domains in one call by one of the
/// methods of the seed paper. Serves one call at a time. A second call, from a different thread or from within the
/// first call, prints an error and returns nothing. Samplers are independent of each other, and their results are
/// bit-identical.
class PoissonSampler : public godot::RefCounted, public ThreadGuarded {
	GDCLASS(PoissonSampler, godot::RefCounted)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "PoissonSampler";

	/// How `sample_domain` fills a rectangle. All methods but the first are those of DomainMethod.
	enum Method : std::int64_t {
		METHOD_TILES, ///< The window of the infinite set that `sample` returns.
		METHOD_NAIVE,
		METHOD_HIERARCHICAL,
		METHOD_ACCUMULATOR,
		METHOD_WAVEFRONT,
	};

	/// Any 64-bit number; a different seed selects a different set.
	void set_seed(int64_t p_seed);
	int64_t get_seed() const;

	/// The minimum distance between any two points, in meters: [min_radius, max_radius]. Any other value is ignored with an error.
	void set_radius(double p_radius);
	double get_radius() const;

	/// Levels of the progressive order, 1 to max_levels. Any other value is ignored with an error. Only the infinite
	/// set uses it.
	void set_progressive_levels(int64_t p_levels);
	int64_t get_progressive_levels() const;

	/// For `sample_domain`. Any other number is ignored with an error.
	void set_method(Method p_method);
	Method get_method() const;

	/// DomainRequest::toroidal.
	void set_toroidal(bool p_toroidal);
	bool is_toroidal() const;

	/// True if whole domains are filled by DomainSampler<double>; otherwise by DomainSampler<float>.
	void set_double_precision(bool p_double_precision);
	bool is_double_precision() const;

	/// DomainRequest::cell_size, in radii: 0 to max_cell_size. Any other value is ignored with an error.
	void set_cell_size(double p_cell_size);
	double get_cell_size() const;

	/// The points of the set in a half-open rectangle in meters, with positions in single precision. If the rectangle is refused, prints
	/// an error and returns no points. The result is never null.
	godot::Ref<PoissonPoints> sample(const godot::Rect2 &p_rect);

	/// Does the same as `sample` for the rectangle [min, max). Positions are in double precision, exact at any distance from the origin.
	godot::Ref<PoissonPoints> sample_exact(double p_min_x, double p_min_y, double p_max_x, double p_max_y);

	/// Fills a rectangle in meters with one set by `method`. Positions are the rectangle's corner plus those of the
	/// core, rounded once to single precision, downwards if they would otherwise reach the far edge. ScriptProgress
	/// calls `p_progress`. If DomainRequest or PointSet excludes the request, prints an error and returns nothing. A
	/// cancelled request also returns nothing.
	godot::PackedVector2Array sample_domain(const godot::Rect2 &p_rect, const godot::Callable &p_progress);

	/// Does the same as `sample_domain` for the rectangle [min, max). Positions are in double precision, without IDs and ranks.
	godot::Ref<PoissonPoints> sample_domain_exact(
			double p_min_x, double p_min_y, double p_max_x, double p_max_y, const godot::Callable &p_progress);

	/// The points of the set on the triangles of a mesh, in meters, in the space after the transform. Limited to the
	/// half-open window, unless that is AABB(). A refused call prints an error and returns no points. The result is
	/// never null.
	godot::Ref<PoissonSurfacePoints> sample_surface(
			const godot::Ref<godot::Mesh> &p_mesh, const godot::Transform3D &p_transform, const godot::AABB &p_window);

	/// The points of the set on triangles with three corners each, as Mesh.get_faces returns them. In all other
	/// respects like `sample_surface`.
	godot::Ref<PoissonSurfacePoints> sample_faces(
			const godot::PackedVector3Array &p_faces, const godot::AABB &p_window);

	/// Ends the call in progress within 50 milliseconds, plus the time that the system needs to release a large
	/// workspace. That call then returns nothing. May be called on any thread, and from a progress callable. Has no
	/// effect on calls that have not begun.
	void cancel();

	/// Statistics of the last whole domain that was filled completely: DomainStats.
	godot::Dictionary get_stats() const;

protected:
	static void _bind_methods();

private:
	/// One call in progress. Refused if the sampler already has one. Keeps the sampler alive, even if scripts release
	/// it in the meantime.
	class Turn {
	public:
		Turn(PoissonSampler *p_sampler, const char *p_method);
		~Turn();
		Turn(const Turn &) = delete;
		Turn &operator=(const Turn &) = delete;

		bool granted() const { return granted_; }

	private:
		godot::Ref<PoissonSampler> sampler_;
		bool granted_;
	};

	bool try_set(const PointSet &p_set);
	struct Faces;
	static Status read_mesh(
			const godot::Ref<godot::Mesh> &p_mesh, const godot::Transform3D &p_transform, Faces &r_faces);
	/// `p_property` is what `read` reads, for an error.
	godot::Ref<PoissonSurfacePoints> sample_triangles(const Turn &p_turn, const char *p_property,
			const godot::AABB &p_window, bool mirrored, const std::function<Status(Faces &r_faces)> &read);
	std::span<const SamplePoint> fetch(const Turn &p_turn, const Rect &p_rect);
	DomainRequest domain_request(const glm::dvec2 &p_size) const;
	void report_domain(const DomainRequest &p_request, Status p_status) const;

	/// Fills the domain and passes it to the writer. If the request is refused or cancelled, the writer stays empty.
	template <typename Writer>
	void write_domain(const Turn &p_turn, const Rect &p_rect, const glm::dvec2 &p_size,
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
	std::vector<SamplePoint> points_; ///< The points of the last call; kept to reuse their memory.
	DomainStats stats_;
	std::atomic<bool> busy_ = false;
	std::atomic<bool> cancelled_ = false; ///< Cancels the call in progress.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::PoissonSampler::Method)
