#pragma once

#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/point_set.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/sampler/poisson_points.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/rect2.hpp>

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The samplers themselves, for scripts: windows onto one infinite Poisson-disk set, and whole domains at once by one of the
/// methods of the seed paper. Serves one call at a time: a second one, from another thread or from within the first,
/// prints an error and gives nothing. Objects are independent of each other and agree bit for bit.
class PoissonSampler : public godot::RefCounted, public ThreadGuarded {
	GDCLASS(PoissonSampler, godot::RefCounted)
	THICKET_GUARDED_METHODS(owner)

public:
	/// How `sample_domain` fills a rectangle; see DomainMethod for all but the first.
	enum Method : std::int64_t {
		METHOD_TILES, ///< The window of the infinite set that `sample` looks at.
		METHOD_NAIVE,
		METHOD_HIERARCHICAL,
		METHOD_ACCUMULATOR,
		METHOD_WAVEFRONT,
	};

	/// Any 64-bit number; other seeds name other sets.
	void set_seed(int64_t p_seed);
	int64_t get_seed() const;

	/// Meters between any two points, at least; [min_radius, max_radius]. Anything else prints an error and is ignored.
	void set_radius(double p_radius);
	double get_radius() const;

	/// Levels of the progressive order, 1 to max_levels. Anything else prints an error and is ignored. For the infinite set.
	void set_progressive_levels(int64_t p_levels);
	int64_t get_progressive_levels() const;

	/// For `sample_domain`. Any other number prints an error and is ignored.
	void set_method(Method p_method);
	Method get_method() const;

	/// DomainRequest::toroidal.
	void set_toroidal(bool p_toroidal);
	bool is_toroidal() const;

	/// Whether whole domains are filled by DomainSampler<double>; by DomainSampler<float> if not.
	void set_double_precision(bool p_double_precision);
	bool is_double_precision() const;

	/// DomainRequest::cell_size, in radii: 0 to max_cell_size. Anything else prints an error and is ignored.
	void set_cell_size(double p_cell_size);
	double get_cell_size() const;

	/// The points of the set in a half-open rectangle in meters, with positions in single precision. A refused rectangle prints
	/// an error and gives no points; the result is never null.
	godot::Ref<PoissonPoints> sample(const godot::Rect2 &p_rect);

	/// As `sample`, with the rectangle as [min, max) and positions in double precision, exact at any distance from the origin.
	godot::Ref<PoissonPoints> sample_exact(double p_min_x, double p_min_y, double p_max_x, double p_max_y);

	/// Fills a rectangle in meters with one set by `method`. Positions are the rectangle's corner plus those of the core,
	/// rounded to single precision once, downwards where the far edge would be next. `p_progress` is told by ScriptProgress.
	/// A request that DomainRequest or PointSet excludes prints an error and gives nothing, a cancelled one gives nothing.
	godot::PackedVector2Array sample_domain(const godot::Rect2 &p_rect, const godot::Callable &p_progress);

	/// As `sample_domain`, with the rectangle as [min, max) and positions in double precision, without ids and ranks.
	godot::Ref<PoissonPoints> sample_domain_exact(
			double p_min_x, double p_min_y, double p_max_x, double p_max_y, const godot::Callable &p_progress);

	/// Ends the call that is under way within 50 milliseconds, and what the system takes to get a large workspace back; it
	/// gives nothing. From any thread, and from a progress callable. Without effect on calls that have not begun.
	void cancel();

	/// Figures of the last whole domain that was filled to its end: DomainStats.
	godot::Dictionary get_stats() const;

protected:
	static void _bind_methods();

private:
	/// A call under way: refused if there is one already. Keeps the sampler alive, whatever scripts let go of meanwhile.
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
	std::span<const SamplePoint> fetch(const Turn &p_turn, const Rect &p_rect);
	DomainRequest domain_request(const glm::dvec2 &p_size) const;
	void report_domain(const DomainRequest &p_request, Status p_status) const;

	/// Fills the domain and hands it to the writer, which stays empty if that was refused or cancelled.
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
	std::vector<SamplePoint> points_; ///< Of the last call; kept for its memory.
	DomainStats stats_;
	std::atomic<bool> busy_ = false;
	std::atomic<bool> cancelled_ = false; ///< Of the call under way.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::PoissonSampler::Method)
