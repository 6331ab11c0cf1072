/* A flight through a scene in C11, over two views and several instances, for comparison with the same flight in C++. */
#ifndef XGC_TEST_FLIGHT_H
#define XGC_TEST_FLIGHT_H

#include <xgc/xgc.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { kFlightFrames = 48, kFlightInstances = 40, kFlightArena = 1 << 20, kFlightStaging = 1 << 13 };

/* What a frame gave, hashed. */
typedef struct FlightFrame {
    uint64_t levels[2]; /* a view each */
    uint64_t draws[2];
    uint64_t copies; /* and what they copy */
    uint64_t stats;
} FlightFrame;

/* What both flights do in a frame. */
typedef struct FlightStep {
    float eye[3];
    float forward[3]; /* of the second view */
    float worldToClip[16];
    uint32_t triangleBudget; /* of the first view */
    uint32_t morphs;         /* likewise */
    float bands[3];          /* of the second view, where it takes them */
    uint32_t usesBands;
    uint32_t moved; /* the instance that moves in this frame */
    float toWorld[16];
} FlightStep;
FlightStep flightStep(uint32_t frame, float radius);
/* Where an instance starts. */
void flightPlace(uint32_t instance, float radius, float toWorld[16]);

uint64_t flightHash(uint64_t hash, const void* bytes, size_t count);

/* A job system that runs backwards and counts. */
void flightRunJobs(void* calls, uint32_t count, void (*job)(void* data, uint32_t index), void* data);

/* Refuses every argument that a caller can easily make wrong, and goes on as if nothing had been. Null, or the check
 * that failed. */
const char* checkRefusals(const void* bytes, size_t byteCount);
/* Allocator and log; no object may live. */
const char* checkServices(const void* bytes, size_t byteCount);
/* Hosts of other sizes of structs. */
const char* checkSizes(void);
/* What an asset tells, and levels and indices of one without a scene. Triangles of levels that are chosen by error, and
 * of those by distance. */
const char* readAsset(const void* bytes, size_t byteCount, uint64_t hashes[2]);

/* Flies over two assets. Null, or the call that failed. `jobCalls`: counts runs of the job system. */
const char* fly(const void* const bytes[2], const size_t byteCounts[2], FlightFrame frames[kFlightFrames],
                uint32_t* jobCalls);

#ifdef __cplusplus
}
#endif

#endif
