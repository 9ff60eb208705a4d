#include "core/c_api/thicket.h"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/set_digest.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

using thicket::ErrorCode;
using thicket::Progress;
using thicket::SamplePoint;
using thicket::Status;
using thicket::at_most;

struct thicket_sampler {
	thicket::TileSampler tiles;
	/// The points of the last call: points of a set, or positions of a whole domain.
	std::variant<std::vector<SamplePoint>, std::vector<glm::dvec2>, std::vector<glm::vec2>> result;
	std::array<char, 512> message{};
	std::atomic<bool> busy = false;
	std::atomic<bool> cancelled = false; ///< Set by thicket_cancel; ends the call in progress.
};

namespace {

// Points are copied without conversion, so both structs must have the same layout.
static_assert(sizeof(thicket_point) == sizeof(SamplePoint));
static_assert(offsetof(thicket_point, x) == offsetof(SamplePoint, position));
static_assert(offsetof(thicket_point, id) == offsetof(SamplePoint, id));
static_assert(offsetof(thicket_point, rank) == offsetof(SamplePoint, rank));
static_assert(offsetof(thicket_point, level) == offsetof(SamplePoint, level));

thicket_code code_of(ErrorCode code) {
	switch (code) {
		case ErrorCode::none: return THICKET_OK;
		case ErrorCode::not_finite: return THICKET_NOT_FINITE;
		case ErrorCode::not_positive: return THICKET_NOT_POSITIVE;
		case ErrorCode::out_of_range: return THICKET_OUT_OF_RANGE;
		case ErrorCode::inverted: return THICKET_INVERTED;
		case ErrorCode::too_many_points: return THICKET_TOO_MANY_POINTS;
		case ErrorCode::missing: return THICKET_MISSING;
		case ErrorCode::out_of_memory: return THICKET_OUT_OF_MEMORY;
		case ErrorCode::margin_too_wide: return THICKET_MARGIN_TOO_WIDE;
		case ErrorCode::cancelled: return THICKET_CANCELLED;
		default: return THICKET_FAILED;
	}
}

void notify(thicket_sampler &r_sampler, const char *text) {
	const std::size_t length = std::min(std::strlen(text), r_sampler.message.size() - 1);
	std::memcpy(r_sampler.message.data(), text, length);
	r_sampler.message[length] = '\0';
}

/// Runs a call to a sampler. Returns THICKET_BUSY while another call is in progress.
/// `work(sampler)` returns a Status. For domains, `request` improves the error message; otherwise
/// it is null.
template <typename Work>
thicket_code call(thicket_sampler *sampler, const Work &work, const thicket::DomainRequest *request = nullptr) {
	if (sampler == nullptr) {
		return THICKET_MISSING;
	}
	if (sampler->busy.exchange(true, std::memory_order_acquire)) {
		return THICKET_BUSY;
	}
	const Status status = thicket::guarded("sampler", 0.0, [&] { return work(*sampler); });
	notify(*sampler, "");
	if (!status.ok()) {
		const Status reported = thicket::guarded("message", 0.0, [&] {
			notify(*sampler, (request != nullptr ? describe(*request, status) : describe(status)).c_str());
		});
		if (!reported.ok()) {
			notify(*sampler, "there is not enough memory for an error message");
		}
	}
	sampler->busy.store(false, std::memory_order_release);
	return code_of(status.code);
}

/// Returns the sampler's points as a list of `Point`. Replaces a list of another type.
template <typename Point>
std::vector<Point> &held_as(thicket_sampler &r_sampler) {
	if (auto *known = std::get_if<std::vector<Point>>(&r_sampler.result)) {
		// The list is returned as it is to reuse its memory; the caller clears it.
		return *known;
	}
	return r_sampler.result.emplace<std::vector<Point>>();
}

std::uint64_t count_of(const thicket_sampler &sampler) {
	return std::visit([](const auto &points) { return std::uint64_t{points.size()}; }, sampler.result);
}

/// Runs `sample(progress, points)`. After any failure, the sampler has no points.
template <typename Point, typename Sample>
Status make(thicket_sampler &r_sampler, const thicket_watch *watch, std::uint64_t *r_count, const Sample &sample) {
	const thicket_watch watcher = watch != nullptr ? *watch : thicket_watch{};
	Progress progress{.cancel = &r_sampler.cancelled, .report = {}};
	const auto report = [&](double fraction, std::uint64_t points) {
		if (watcher.progress(watcher.user, fraction, points) != 0) {
			r_sampler.cancelled.store(true, std::memory_order_relaxed);
		}
	};
	if (watcher.progress != nullptr) {
		progress.report = std::cref(report);
	}
	std::vector<Point> &points = held_as<Point>(r_sampler);
	points.clear();
	Status status = sample(progress, points);
	if (status.ok() && progress.cancelled()) {
		status = {ErrorCode::cancelled, "sample", 0.0};
	}
	if (!status.ok()) {
		points.clear();
	} else if (r_count != nullptr) {
		*r_count = points.size();
	}
	return status;
}

template <typename Real>
Status fill(thicket_sampler &r_sampler, const thicket::DomainRequest &request, const thicket_watch *watch,
		std::uint64_t *r_count) {
	using Points = std::vector<glm::vec<2, Real>>;
	return make<glm::vec<2, Real>>(r_sampler, watch, r_count, [&](const Progress &progress, Points &r_points) {
		return thicket::DomainSampler<Real>().sample(request, r_points, progress);
	});
}

Status validate(const thicket_domain &domain) {
	return thicket::first_failure(thicket::check_range("method", domain.method, THICKET_NAIVE, THICKET_WAVEFRONT),
			thicket::check_range("toroidal", domain.toroidal, 0, 1),
			thicket::check_range("single_precision", domain.single_precision, 0, 1));
}

thicket::DomainRequest request_of(const thicket_domain &domain) {
	using thicket::DomainMethod;
	constexpr std::array methods{
			DomainMethod::naive, DomainMethod::hierarchical, DomainMethod::accumulator, DomainMethod::wavefront};
	thicket::DomainRequest request{
			.size = {domain.size_x, domain.size_y}, .radius = domain.radius, .seed = domain.seed};
	request.method = methods.at(static_cast<std::size_t>(domain.method - THICKET_NAIVE));
	request.toroidal = domain.toroidal != 0;
	request.cell_size = domain.cell_size;
	request.darts_each = domain.darts_each == 0.0 ? request.darts_each : domain.darts_each;
	return request;
}

/// Checks that the sampler has the points [first, first + count) and that `buffer` is not null if
/// it is needed.
Status check_part(const thicket_sampler &sampler, std::uint64_t first, std::uint64_t count, const void *buffer) {
	const std::uint64_t available = count_of(sampler);
	if (first > available) {
		return Status::out_of_range("first", first, at_most(available, "the points in the sampler"));
	}
	if (count > available - first) {
		return Status::out_of_range("count", count, at_most(available - first, "the points from first on"));
	}
	if (buffer == nullptr && count > 0) {
		return {ErrorCode::missing, "buffer", 0.0};
	}
	return {};
}

glm::dvec2 position_of(const SamplePoint &point) { return point.position; }

template <typename Real>
glm::dvec2 position_of(const glm::vec<2, Real> &position) {
	return position;
}

} // namespace

std::uint32_t thicket_c_version(void) noexcept { return THICKET_C_VERSION; }

thicket_sampler *thicket_sampler_new(void) noexcept {
	thicket_sampler *created = nullptr;
	const Status status = thicket::guarded(
			"sampler", sizeof(thicket_sampler), [&] { created = std::make_unique<thicket_sampler>().release(); });
	return status.ok() ? created : nullptr;
}

void thicket_sampler_free(thicket_sampler *sampler) noexcept { delete sampler; }

const char *thicket_message(const thicket_sampler *sampler) noexcept {
	if (sampler == nullptr) {
		return "sampler is missing";
	}
	return sampler->busy.load(std::memory_order_acquire) ? "another call to this sampler is running"
														 : sampler->message.data();
}

thicket_code thicket_sample(thicket_sampler *sampler, const thicket_set *set, const thicket_rect *rect,
		const thicket_watch *watch, std::uint64_t *r_count) noexcept {
	return call(sampler, [&](thicket_sampler &own) -> Status {
		own.cancelled.store(false, std::memory_order_relaxed);
		return make<SamplePoint>(
				own, watch, r_count, [&](const Progress &progress, std::vector<SamplePoint> &r_points) -> Status {
					if (set == nullptr || rect == nullptr) {
						return {ErrorCode::missing, set == nullptr ? "set" : "rect", 0.0};
					}
					return own.tiles.sample(
							{.seed = set->seed, .radius = set->radius, .levels = set->levels, .layer = set->layer},
							{{rect->min_x, rect->min_y}, {rect->max_x, rect->max_y}}, r_points, progress);
				});
	});
}

thicket_code thicket_sample_domain(thicket_sampler *sampler, const thicket_domain *domain, const thicket_watch *watch,
		std::uint64_t *r_count) noexcept {
	thicket::DomainRequest request;
	return call(
			sampler,
			[&](thicket_sampler &own) -> Status {
				own.cancelled.store(false, std::memory_order_relaxed);
				held_as<SamplePoint>(own).clear();
				if (domain == nullptr) {
					return {ErrorCode::missing, "domain", 0.0};
				}
				if (const Status status = validate(*domain); !status.ok()) {
					return status;
				}
				request = request_of(*domain);
				return domain->single_precision != 0 ? fill<float>(own, request, watch, r_count)
													 : fill<double>(own, request, watch, r_count);
			},
			&request);
}

std::uint64_t thicket_count(const thicket_sampler *sampler) noexcept {
	return sampler == nullptr || sampler->busy.load(std::memory_order_acquire) ? 0 : count_of(*sampler);
}

thicket_code thicket_read_points(
		thicket_sampler *sampler, std::uint64_t first, std::uint64_t count, thicket_point *r_points) noexcept {
	return call(sampler, [&](thicket_sampler &own) -> Status {
		const auto *points = std::get_if<std::vector<SamplePoint>>(&own.result);
		if (points == nullptr) {
			return {ErrorCode::missing, "a previous call to thicket_sample", 0.0};
		}
		if (const Status status = check_part(own, first, count, r_points); !status.ok()) {
			return status;
		}
		if (count > 0) {
			std::memcpy(r_points, points->data() + first, static_cast<std::size_t>(count) * sizeof(thicket_point));
		}
		return {};
	});
}

thicket_code thicket_read_positions(
		thicket_sampler *sampler, std::uint64_t first, std::uint64_t count, double *r_xy) noexcept {
	return call(sampler, [&](thicket_sampler &own) -> Status {
		if (const Status status = check_part(own, first, count, r_xy); !status.ok()) {
			return status;
		}
		std::visit(
				[&](const auto &points) {
					for (std::uint64_t i = 0; i < count; ++i) {
						const glm::dvec2 position = position_of(points[static_cast<std::size_t>(first + i)]);
						r_xy[2 * i] = position.x;
						r_xy[2 * i + 1] = position.y;
					}
				},
				own.result);
		return {};
	});
}

thicket_code thicket_digest(thicket_sampler *sampler, std::uint64_t *r_places, std::uint64_t *r_ranks) noexcept {
	return call(sampler, [&](thicket_sampler &own) -> Status {
		if (r_places == nullptr) {
			return {ErrorCode::missing, "r_places", 0.0};
		}
		thicket::SetDigest digests;
		if (const auto *points = std::get_if<std::vector<SamplePoint>>(&own.result)) {
			digests = digest(std::span<const SamplePoint>(*points));
		} else if (const auto *doubles = std::get_if<std::vector<glm::dvec2>>(&own.result)) {
			digests.points = thicket::digest(*doubles);
		} else {
			digests.points = thicket::digest(std::get<std::vector<glm::vec2>>(own.result));
		}
		*r_places = digests.points;
		if (r_ranks != nullptr) {
			*r_ranks = digests.ranks;
		}
		return {};
	});
}

void thicket_cancel(thicket_sampler *sampler) noexcept {
	if (sampler != nullptr) {
		sampler->cancelled.store(true, std::memory_order_relaxed);
	}
}
