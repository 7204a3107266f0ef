# The command in a small image: docker build -t twinslip .
# Files go through the folder of work: docker run --rm -v "$PWD:/data" twinslip run relaxation -o run.csv
FROM rust:1-bookworm AS build
WORKDIR /src
COPY . .
RUN apt-get update -qq && packaging/build deb

FROM debian:bookworm-slim
COPY --from=build /src/target/packages/twinslip_*.deb /tmp/twinslip.deb
RUN dpkg --install /tmp/twinslip.deb \
    && rm /tmp/twinslip.deb \
    && useradd --create-home twinslip \
    && install --directory --owner=twinslip /data
USER twinslip
WORKDIR /data
ENTRYPOINT ["twinslip"]
CMD ["--help"]
