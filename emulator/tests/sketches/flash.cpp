// Erases and programs a sector of its own flash; the command runs from RAM.
#include <Arduino.h>

static const uint32_t SECTOR = 0x30000;

FASTRUN __attribute__((noinline)) static uint8_t launch() {
  FTFL_FSTAT = 0x70;
  FTFL_FSTAT = FTFL_FSTAT_CCIF;
  while (!(FTFL_FSTAT & FTFL_FSTAT_CCIF)) {
  }
  return FTFL_FSTAT & 0x71;
}

static uint8_t command(uint8_t code, uint32_t address, uint32_t data = 0) {
  FTFL_FCCOB0 = code;
  FTFL_FCCOB1 = address >> 16;
  FTFL_FCCOB2 = address >> 8;
  FTFL_FCCOB3 = address;
  FTFL_FCCOB4 = data >> 24;
  FTFL_FCCOB5 = data >> 16;
  FTFL_FCCOB6 = data >> 8;
  FTFL_FCCOB7 = data;
  __disable_irq();
  uint8_t status = launch();
  __enable_irq();
  return status;
}

void setup() {
  while (!Serial) {
  }
  volatile uint32_t *word = (volatile uint32_t *)SECTOR;
  Serial.printf("erase %02x\n", command(0x09, SECTOR));
  Serial.printf("blank %08lx\n", word[0]);
  Serial.printf("program %02x\n", command(0x06, SECTOR, 0xDEADBEEF));
  Serial.printf("read %08lx %08lx\n", word[0], word[1]);
  Serial.printf("erase %02x\n", command(0x09, SECTOR));
  Serial.printf("blank %08lx\n", word[0]);
}

void loop() {}
