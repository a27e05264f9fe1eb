/* Traces the same rays as accel.rs straight through Embree: the yardstick for the cost of the Rust layer.
 *
 * Usage: embree_direct FILE
 * FILE (written by accel.rs), little endian: u32 vertices, u32 triangles, u32 rays; then vertices of
 * 3 floats, triangles of 3 u32, rays of 8 floats (org, tmin, dir, tmax).
 * For every line "WIDTH COHERENT" on the input it traces all rays once, closest hits and then shadow
 * rays, in packets of 1, 4, 8 or 16, and answers with the two times in seconds. So the caller can take
 * turns with it, pass by pass, and both see the same neighbours on a busy machine.
 */
#include <immintrin.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if defined(EMBREE4)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

typedef struct {
  float org[3], tmin, dir[3], tmax;
} Ray;

typedef struct {
  float t, u, v;
  unsigned prim, shape, instance;
} Hit;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

static void *get(FILE *f, size_t size, size_t count) {
  void *p = malloc(size * count + 16);
  if (!p || fread(p, size, count, f) != count) {
    fprintf(stderr, "embree_direct: the file is too short\n");
    exit(1);
  }
  return p;
}

static int coherent;

#if defined(EMBREE4)
#define INTERSECT(N, valid, packet)                                     \
  do {                                                                  \
    struct RTCIntersectArguments a;                                     \
    rtcInitIntersectArguments(&a);                                      \
    if (coherent) a.flags = RTC_RAY_QUERY_FLAG_COHERENT;                \
    rtcIntersect##N(valid scene, packet, &a);                           \
  } while (0)
#define OCCLUDED(N, valid, packet)                                      \
  do {                                                                  \
    struct RTCOccludedArguments a;                                      \
    rtcInitOccludedArguments(&a);                                       \
    if (coherent) a.flags = RTC_RAY_QUERY_FLAG_COHERENT;                \
    rtcOccluded##N(valid scene, packet, &a);                            \
  } while (0)
#else
#define CONTEXT                                                         \
  struct RTCIntersectContext c;                                         \
  rtcInitIntersectContext(&c);                                          \
  if (coherent) c.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT
#define INTERSECT(N, valid, packet)                                     \
  do {                                                                  \
    CONTEXT;                                                            \
    rtcIntersect##N(valid scene, &c, packet);                           \
  } while (0)
#define OCCLUDED(N, valid, packet)                                      \
  do {                                                                  \
    CONTEXT;                                                            \
    rtcOccluded##N(valid scene, &c, packet);                            \
  } while (0)
#endif

static void closest1(RTCScene scene, const Ray *rays, Hit *hits, size_t count) {
  for (size_t i = 0; i < count; i++) {
    struct RTCRayHit q;
    memset(&q, 0, sizeof q);
    memcpy(&q.ray.org_x, rays[i].org, 16);
    memcpy(&q.ray.dir_x, rays[i].dir, 12);
    q.ray.tfar = rays[i].tmax;
    q.ray.mask = ~0u;
    q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    INTERSECT(1, , &q);
    Hit h = {q.ray.tfar, q.hit.u, q.hit.v, q.hit.primID, q.hit.geomID, q.hit.instID[0]};
    hits[i] = h;
  }
}

static void shadow1(RTCScene scene, const Ray *rays, unsigned char *blocked, size_t count) {
  for (size_t i = 0; i < count; i++) {
    struct RTCRay q;
    memset(&q, 0, sizeof q);
    memcpy(&q.org_x, rays[i].org, 16);
    memcpy(&q.dir_x, rays[i].dir, 12);
    q.tfar = rays[i].tmax;
    q.mask = ~0u;
    OCCLUDED(1, , &q);
    blocked[i] = q.tfar < 0;
  }
}

#define FILL(N, r)                                                      \
  for (int k = 0; k < N; k++) {                                         \
    const Ray *s = rays + i + k;                                        \
    (r).org_x[k] = s->org[0], (r).org_y[k] = s->org[1], (r).org_z[k] = s->org[2]; \
    (r).dir_x[k] = s->dir[0], (r).dir_y[k] = s->dir[1], (r).dir_z[k] = s->dir[2]; \
    (r).tnear[k] = s->tmin, (r).tfar[k] = s->tmax;                      \
  }

#define PACKETS(N)                                                                               \
  static void closest##N(RTCScene scene, const Ray *rays, Hit *hits, size_t count) {             \
    int valid[N] __attribute__((aligned(64)));                                                   \
    struct RTCRayHit##N q;                                                                       \
    memset(&q, 0, sizeof q);                                                                     \
    memset(valid, ~0, sizeof valid);                                                             \
    memset(q.ray.mask, ~0, sizeof q.ray.mask);                                                   \
    for (size_t i = 0; i + N <= count; i += N) {                                                 \
      FILL(N, q.ray)                                                                             \
      memset(q.hit.geomID, ~0, sizeof q.hit.geomID);                                             \
      INTERSECT(N, valid COMMA, &q);                                                             \
      for (int k = 0; k < N; k++) {                                                              \
        Hit h = {q.ray.tfar[k],   q.hit.u[k],      q.hit.v[k],                                   \
                 q.hit.primID[k], q.hit.geomID[k], q.hit.instID[0][k]};                          \
        hits[i + k] = h;                                                                         \
      }                                                                                          \
    }                                                                                            \
  }                                                                                              \
  static void shadow##N(RTCScene scene, const Ray *rays, unsigned char *blocked, size_t count) { \
    int valid[N] __attribute__((aligned(64)));                                                   \
    struct RTCRay##N q;                                                                          \
    memset(&q, 0, sizeof q);                                                                     \
    memset(valid, ~0, sizeof valid);                                                             \
    memset(q.mask, ~0, sizeof q.mask);                                                           \
    for (size_t i = 0; i + N <= count; i += N) {                                                 \
      FILL(N, q)                                                                                 \
      OCCLUDED(N, valid COMMA, &q);                                                              \
      for (int k = 0; k < N; k++) blocked[i + k] = q.tfar[k] < 0;                                \
    }                                                                                            \
  }
#define COMMA ,
PACKETS(4)
PACKETS(8)
PACKETS(16)

int main(int argc, char **argv) {
  FILE *f = argc > 1 ? fopen(argv[1], "rb") : NULL;
  if (!f) {
    fprintf(stderr, "usage: embree_direct FILE\n");
    return 1;
  }
  unsigned *n = get(f, 4, 3);
  float *vertices = get(f, 12, n[0]);
  unsigned *triangles = get(f, 12, n[1]);
  Ray *rays = get(f, sizeof(Ray), n[2]);
  fclose(f);
  Hit *hits = malloc(sizeof(Hit) * n[2]);
  unsigned char *blocked = malloc(n[2]);
  if (!hits || !blocked) return 1;

  _mm_setcsr(_mm_getcsr() | 0x8040);
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, 12, n[0]);
  rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles, 0, 12, n[1]);
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene, mesh);
  rtcReleaseGeometry(mesh);
  rtcCommitScene(scene);

  int width;
  while (scanf("%d %d", &width, &coherent) == 2) {
    double a = now();
    switch (width) {
      case 4: closest4(scene, rays, hits, n[2]); break;
      case 8: closest8(scene, rays, hits, n[2]); break;
      case 16: closest16(scene, rays, hits, n[2]); break;
      default: closest1(scene, rays, hits, n[2]);
    }
    double b = now();
    switch (width) {
      case 4: shadow4(scene, rays, blocked, n[2]); break;
      case 8: shadow8(scene, rays, blocked, n[2]); break;
      case 16: shadow16(scene, rays, blocked, n[2]); break;
      default: shadow1(scene, rays, blocked, n[2]);
    }
    double c = now();
    printf("%.9f %.9f\n", b - a, c - b);
    fflush(stdout);
  }
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return 0;
}
