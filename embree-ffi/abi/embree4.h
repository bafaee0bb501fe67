/* The part of Embree's C interface that embree-ffi uses, as it is from 4.3 on.
 *
 * Written for this crate, self-contained (no include, so that libclang alone can read it), and checked from two sides:
 * against the library itself when it is loaded (src/layout.rs) and against the independent `embree4-sys` (tests/witness.rs).
 *
 * It describes the default build: RTC_MAX_INSTANCE_LEVEL_COUNT 1, instance arrays on, RTC_MIN_WIDTH off.
 * src/bindings.rs is generated from it by `cargo run -p embree-ffi --features regenerate --example bindings`.
 */

typedef __SIZE_TYPE__ size_t;
typedef __PTRDIFF_TYPE__ ssize_t;

typedef struct RTCDeviceTy* RTCDevice;
typedef struct RTCSceneTy* RTCScene;
typedef struct RTCGeometryTy* RTCGeometry;

/* Rays and hits: one, and in columns of 4, 8 and 16. */

struct __attribute__((aligned(16))) RTCRay {
  float org_x, org_y, org_z, tnear;
  float dir_x, dir_y, dir_z, time;
  float tfar;
  unsigned int mask, id, flags;
};

struct __attribute__((aligned(16))) RTCHit {
  float Ng_x, Ng_y, Ng_z;
  float u, v;
  unsigned int primID, geomID;
  unsigned int instID[1];
  unsigned int instPrimID[1]; /* new in 4.3 */
};

struct RTCRayHit {
  struct RTCRay ray;
  struct RTCHit hit;
};

#define RAY_PACKET(WIDTH, ALIGNMENT)                                        \
  struct __attribute__((aligned(ALIGNMENT))) RTCRay##WIDTH {                \
    float org_x[WIDTH], org_y[WIDTH], org_z[WIDTH], tnear[WIDTH];           \
    float dir_x[WIDTH], dir_y[WIDTH], dir_z[WIDTH], time[WIDTH];            \
    float tfar[WIDTH];                                                      \
    unsigned int mask[WIDTH], id[WIDTH], flags[WIDTH];                      \
  };                                                                        \
  struct __attribute__((aligned(ALIGNMENT))) RTCHit##WIDTH {                \
    float Ng_x[WIDTH], Ng_y[WIDTH], Ng_z[WIDTH];                            \
    float u[WIDTH], v[WIDTH];                                               \
    unsigned int primID[WIDTH], geomID[WIDTH];                              \
    unsigned int instID[1][WIDTH];                                          \
    unsigned int instPrimID[1][WIDTH]; /* new in 4.3 */                     \
  };

RAY_PACKET(4, 16)
RAY_PACKET(8, 32)
RAY_PACKET(16, 64)

/* Constants. */

enum RTCDeviceProperty {
  RTC_DEVICE_PROPERTY_VERSION = 0,
  RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED = 32,
  RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED = 33,
  RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED = 34,
  RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED = 64,
  RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED = 65,
  RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED = 66,
  RTC_DEVICE_PROPERTY_IGNORE_INVALID_RAYS_ENABLED = 67,
  RTC_DEVICE_PROPERTY_COMPACT_POLYS_ENABLED = 68,
  RTC_DEVICE_PROPERTY_TRIANGLE_GEOMETRY_SUPPORTED = 96
};

enum RTCError {
  RTC_ERROR_NONE = 0,
  RTC_ERROR_UNKNOWN = 1,
  RTC_ERROR_INVALID_ARGUMENT = 2,
  RTC_ERROR_INVALID_OPERATION = 3,
  RTC_ERROR_OUT_OF_MEMORY = 4,
  RTC_ERROR_UNSUPPORTED_CPU = 5,
  RTC_ERROR_CANCELLED = 6,
  RTC_ERROR_LEVEL_ZERO_RAYTRACING_SUPPORT_MISSING = 7 /* new in 4.3.3 */
};

enum RTCSceneFlags {
  RTC_SCENE_FLAG_NONE = 0,
  RTC_SCENE_FLAG_DYNAMIC = 1 << 0,
  RTC_SCENE_FLAG_COMPACT = 1 << 1,
  RTC_SCENE_FLAG_ROBUST = 1 << 2,
  RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS = 1 << 3
};

enum RTCBuildQuality {
  RTC_BUILD_QUALITY_LOW = 0,
  RTC_BUILD_QUALITY_MEDIUM = 1,
  RTC_BUILD_QUALITY_HIGH = 2
};

enum RTCGeometryType { RTC_GEOMETRY_TYPE_TRIANGLE = 0 };

enum RTCBufferType { RTC_BUFFER_TYPE_INDEX = 0, RTC_BUFFER_TYPE_VERTEX = 1 };

enum RTCFormat { RTC_FORMAT_UINT3 = 0x5003, RTC_FORMAT_FLOAT3 = 0x9003 };

enum RTCRayQueryFlags {
  RTC_RAY_QUERY_FLAG_NONE = 0,
  RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER = 1 << 1,
  RTC_RAY_QUERY_FLAG_COHERENT = 1 << 16
};

enum RTCFeatureFlags { RTC_FEATURE_FLAG_NONE = 0, RTC_FEATURE_FLAG_ALL = 0xffffffff };

/* What a query may be given, and what a filter is told. */

struct RTCRayQueryContext {
  unsigned int instID[1];
  unsigned int instPrimID[1]; /* new in 4.3 */
};

struct RTCFilterFunctionNArguments {
  int* valid;
  void* geometryUserPtr;
  struct RTCRayQueryContext* context;
  struct RTCRayN* ray;
  struct RTCHitN* hit;
  unsigned int N;
};

typedef void (*RTCFilterFunctionN)(const struct RTCFilterFunctionNArguments* args);
struct RTCIntersectFunctionNArguments;
typedef void (*RTCIntersectFunctionN)(const struct RTCIntersectFunctionNArguments* args);
struct RTCOccludedFunctionNArguments;
typedef void (*RTCOccludedFunctionN)(const struct RTCOccludedFunctionNArguments* args);

struct RTCIntersectArguments {
  enum RTCRayQueryFlags flags;
  enum RTCFeatureFlags feature_mask;
  struct RTCRayQueryContext* context;
  RTCFilterFunctionN filter;
  RTCIntersectFunctionN intersect;
};

struct RTCOccludedArguments {
  enum RTCRayQueryFlags flags;
  enum RTCFeatureFlags feature_mask;
  struct RTCRayQueryContext* context;
  RTCFilterFunctionN filter;
  RTCOccludedFunctionN occluded;
};

typedef void (*RTCErrorFunction)(void* userPtr, enum RTCError code, const char* str);
typedef _Bool (*RTCMemoryMonitorFunction)(void* ptr, ssize_t bytes, _Bool post);
typedef _Bool (*RTCProgressMonitorFunction)(void* ptr, double n);

/* New in 4.3.3, hence not among the functions a library must have. */
typedef const char* (*RTCGetDeviceLastErrorMessageFunction)(RTCDevice device);

/* Devices. */

RTCDevice rtcNewDevice(const char* config);
void rtcReleaseDevice(RTCDevice device);
ssize_t rtcGetDeviceProperty(RTCDevice device, enum RTCDeviceProperty prop);
enum RTCError rtcGetDeviceError(RTCDevice device);
void rtcSetDeviceErrorFunction(RTCDevice device, RTCErrorFunction error, void* userPtr);
void rtcSetDeviceMemoryMonitorFunction(RTCDevice device, RTCMemoryMonitorFunction memoryMonitor, void* userPtr);

/* Geometries. */

RTCGeometry rtcNewGeometry(RTCDevice device, enum RTCGeometryType type);
void rtcReleaseGeometry(RTCGeometry geometry);
void rtcCommitGeometry(RTCGeometry geometry);
void rtcSetGeometryMask(RTCGeometry geometry, unsigned int mask);
void* rtcSetNewGeometryBuffer(RTCGeometry geometry, enum RTCBufferType type, unsigned int slot, enum RTCFormat format,
                              size_t byteStride, size_t itemCount);
void rtcSetSharedGeometryBuffer(RTCGeometry geometry, enum RTCBufferType type, unsigned int slot, enum RTCFormat format,
                                const void* ptr, size_t byteOffset, size_t byteStride, size_t itemCount);
void rtcSetGeometryBuildQuality(RTCGeometry geometry, enum RTCBuildQuality quality);

/* Scenes. */

RTCScene rtcNewScene(RTCDevice device);
void rtcReleaseScene(RTCScene scene);
unsigned int rtcAttachGeometry(RTCScene scene, RTCGeometry geometry);
void rtcSetSceneFlags(RTCScene scene, enum RTCSceneFlags flags);
void rtcSetSceneBuildQuality(RTCScene scene, enum RTCBuildQuality quality);
void rtcSetSceneProgressMonitorFunction(RTCScene scene, RTCProgressMonitorFunction progress, void* ptr);
void rtcCommitScene(RTCScene scene);

/* Queries. */

void rtcIntersect1(RTCScene scene, struct RTCRayHit* rayhit, struct RTCIntersectArguments* args);
void rtcOccluded1(RTCScene scene, struct RTCRay* ray, struct RTCOccludedArguments* args);
void rtcOccluded4(const int* valid, RTCScene scene, struct RTCRay4* ray, struct RTCOccludedArguments* args);
void rtcOccluded8(const int* valid, RTCScene scene, struct RTCRay8* ray, struct RTCOccludedArguments* args);
void rtcOccluded16(const int* valid, RTCScene scene, struct RTCRay16* ray, struct RTCOccludedArguments* args);
