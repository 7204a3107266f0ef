# What lies in the folder before the program is called; sourced by the cases of fuzz.py that name files.
mkdir dir sub
printf 'keep\n' > old.csv
ln -s old.csv link.csv
ln -s nothing dangling.csv
ln -s loop.csv loop.csv
head -c 3000 /dev/zero | tr '\0' '\377' > binary.csv
: > empty.csv
head -c 4000 /dev/zero > zeros.csv
printf '# twinslip 0.1.0\n# command: twinslip sweep\n' > header.csv
printf '\357\273\277driving,stiffness\n½,ü\n' > unicode.csv
printf '# twinslip 0.1.0\ndriving\n"1\n2' > quote.csv
printf '# twinslip 0.1.0\n# shard: 1/1000000000\n' > torn.csv
