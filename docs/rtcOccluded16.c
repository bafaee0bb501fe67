/* rtcOccluded16 on a device without AVX-512 writes beyond the packet of rays: see how-wrong.md.
 * cc rtcOccluded16.c -lembree4 && ./a.out      SIGSEGV with isa=avx2, "no crash" with isa=avx512. */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <embree4/rtcore.h>
int main(void) {
  RTCDevice device = rtcNewDevice("isa=avx2");
  RTCScene scene = rtcNewScene(device);
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float* v = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3);
  unsigned* i = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 1);
  memcpy(v, (float[]){0, 0, 0, 1, 0, 0, 0, 1, 0}, 36);
  memcpy(i, (unsigned[]){0, 1, 2}, 12);
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene, mesh);
  rtcCommitScene(scene);
  /* A packet that ends where readable memory ends. */
  char* pages = mmap(NULL, 8192, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  mprotect(pages + 4096, 4096, PROT_NONE);
  struct RTCRay16* rays = (struct RTCRay16*)(pages + 4096 - sizeof(struct RTCRay16));
  int valid[16] __attribute__((aligned(64)));
  for (int k = 0; k < 16; k++) {
    valid[k] = -1;
    rays->org_x[k] = 0.2f; rays->org_y[k] = 0.2f; rays->org_z[k] = -1;
    rays->dir_z[k] = 1; rays->tfar[k] = 10; rays->mask[k] = -1;
  }
  rtcOccluded16(valid, scene, rays, NULL);
  printf("no crash: tfar %g\n", rays->tfar[0]);
}
