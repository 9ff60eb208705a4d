/* Prints the points of a set in a rectangle, and their digest: points SEED RADIUS LEVELS LAYER MIN_X MIN_Y MAX_X MAX_Y */
#include "thicket.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
	if (argc != 9) {
		return EXIT_FAILURE;
	}
	const thicket_set set = {.seed = strtoull(argv[1], NULL, 0),
			.radius = atof(argv[2]),
			.levels = (uint32_t)atoi(argv[3]),
			.layer = (uint16_t)atoi(argv[4])};
	const thicket_rect rect = {atof(argv[5]), atof(argv[6]), atof(argv[7]), atof(argv[8])};
	uint64_t count = 0, places = 0, ranks = 0;
	thicket_sampler *sampler = thicket_sampler_new();
	thicket_code code = thicket_sample(sampler, &set, &rect, NULL, &count);
	thicket_point *points = calloc(count + 1, sizeof(thicket_point));
	code = code ? code : thicket_read_points(sampler, 0, count, points);
	code = code ? code : thicket_digest(sampler, &places, &ranks);
	if (code) {
		fprintf(stderr, "error %d: %s\n", (int)code, thicket_message(sampler));
	}
	for (uint64_t i = 0; !code && i < count; i++) {
		const thicket_point p = points[i];
		printf("%.17g %.17g %" PRIu64 " %" PRIu32 " %" PRIu32 "\n", p.x, p.y, p.id, p.rank, p.level);
	}
	printf("digest %016" PRIx64 " ranks %016" PRIx64 "\n", places, ranks);
	free(points);
	thicket_sampler_free(sampler);
	return code ? EXIT_FAILURE : EXIT_SUCCESS;
}
