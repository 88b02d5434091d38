// Real-time clock, touch sensing, CRC, low-power timer and delay block by their registers.
#include <Arduino.h>

static uint32_t crc32(const char *text) {
  SIM_SCGC6 |= SIM_SCGC6_CRC;
  CRC_CTRL = (1 << 24) | (1 << 26) | (2 << 30) | (2 << 28);
  CRC_GPOLY = 0x04C11DB7;
  CRC_CTRL |= 1 << 25;
  CRC_CRC = 0xFFFFFFFF;
  CRC_CTRL &= ~(1 << 25);
  while (*text) *(volatile uint8_t *)&CRC_CRC = *text++;
  return CRC_CRC;
}

void setup() {
  while (!Serial) {
  }
  Serial.printf("crc %08lx\n", crc32("123456789"));
  Serial.printf("touch %d\n", touchRead(15));
  uint32_t before = Teensy3Clock.get();
  delay(2100);
  Serial.printf("rtc %lu\n", Teensy3Clock.get() - before);

  SIM_SCGC5 |= SIM_SCGC5_LPTIMER;
  LPTMR0_CSR = 0;
  LPTMR0_PSR = LPTMR_PSR_PBYP | LPTMR_PSR_PCS(1);
  LPTMR0_CMR = 24;
  LPTMR0_CSR = LPTMR_CSR_TEN;
  uint32_t start = micros();
  while (!(LPTMR0_CSR & LPTMR_CSR_TCF)) {
  }
  Serial.printf("lptmr us %lu\n", micros() - start);

  SIM_SCGC6 |= SIM_SCGC6_PDB;
  PDB0_MOD = 35999;
  PDB0_IDLY = 35999;
  PDB0_SC = PDB_SC_TRGSEL(15) | PDB_SC_PDBEN | PDB_SC_LDOK;
  PDB0_SC = PDB_SC_TRGSEL(15) | PDB_SC_PDBEN | PDB_SC_SWTRIG;
  start = micros();
  while (!(PDB0_SC & PDB_SC_PDBIF)) {
  }
  Serial.printf("pdb us %lu\n", micros() - start);
}

void loop() {}
